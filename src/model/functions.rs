//! Functions that quadratic splines are made of: sums of B-splines (thesis 8.2.5 and 8.3.1).

/// What a function is for; of knots at one place, it has the first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum FunctionKind {
    /// The B-spline of an edge, or, where the other half of it is in a box spline, half of it.
    Edge([u32; 2]),
    /// The tent of a knot that is pulled apart, with halves of tents of edges that are linear elements.
    Vertex(u32),
    /// All B-splines between two places of which one at least is pulled apart: where both are, the tent of
    /// the edge.
    Tent([u32; 2]),
    /// The two B-splines of a crease with smooth ends, from knot to knot, which are the first two; the last
    /// one is the knot between them.
    Crease([u32; 3]),
    /// The box spline (ZP element) of integral one, for a face in unit coordinates, given by its corners,
    /// counterclockwise.
    Face([u32; 4]),
}

/// A function as a sum of B-splines.
#[derive(Debug, Clone, PartialEq)]
pub struct Function {
    /// What it is for.
    pub kind: FunctionKind,
    /// The sets of links that B-splines belong to, each with a factor.
    pub terms: Vec<([u32; 2], f64)>,
}

//! Functions that quadratic splines are made of: sums of B-splines (thesis 8.2.5 and 8.3.1).

/// What a function is for. A place with several knots is named by its first knot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum FunctionKind {
    /// The B-spline of an edge, or half of it if the other half is in a box spline.
    Edge([u32; 2]),
    /// The tent of a knot that is pulled apart, with half the tent of each linear element that ends there.
    Vertex(u32),
    /// All B-splines between two places of which at least one is pulled apart. If both are, it is the tent of
    /// the edge.
    Tent([u32; 2]),
    /// The two B-splines of a crease with smooth ends. The crease joins the first two knots; the last one is
    /// the knot between them.
    Crease([u32; 3]),
    /// The box spline (ZP element) of integral one, for a face in unit coordinates. The knots are the
    /// corners, counterclockwise.
    Face([u32; 4]),
}

/// A function as a sum of B-splines.
#[derive(Debug, Clone, PartialEq)]
pub struct Function {
    /// What it is for.
    pub kind: FunctionKind,
    /// The terms: B-splines, named by the sets of their links, each with a factor.
    pub terms: Vec<([u32; 2], f64)>,
}

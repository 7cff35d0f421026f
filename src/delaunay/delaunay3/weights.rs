//! The weights of vertices: without them the tetrahedralization is the Delaunay one, with them the regular
//! one, dual to the power diagram.

/// The weight of each vertex.
pub(super) trait Weights: Sync {
    /// Weights make no difference, and cost nothing.
    const ARE_EQUAL: bool;

    fn of(&self, vertex: u32) -> f64;

    fn are_integers(&self) -> bool;

    /// The greatest difference of two weights.
    fn spread(&self) -> f64;
}

/// No weights.
#[derive(Debug)]
pub(super) struct Equal;

impl Weights for Equal {
    const ARE_EQUAL: bool = true;

    #[inline(always)]
    fn of(&self, _: u32) -> f64 {
        0.0
    }

    #[inline(always)]
    fn are_integers(&self) -> bool {
        true
    }

    #[inline(always)]
    fn spread(&self) -> f64 {
        0.0
    }
}

/// Weights by vertex, in an array of their own: that of the vertices stays as dense as without them.
#[derive(Debug)]
pub(super) struct PerVertex {
    weights: Vec<f64>,
    are_integers: bool,
    spread: f64,
}

impl PerVertex {
    /// The weights of all vertices, that at infinity included, which has none of its own.
    pub(super) fn new(mut weights: Vec<f64>) -> PerVertex {
        let fold = |of: fn(f64, f64) -> f64, start: f64| weights.iter().copied().fold(start, of);
        let spread = fold(f64::max, f64::NEG_INFINITY) - fold(f64::min, f64::INFINITY);
        weights.push(0.0);
        let are_integers = weights.iter().all(|weight| weight.fract() == 0.0);
        PerVertex { weights, are_integers, spread }
    }
}

impl Weights for PerVertex {
    const ARE_EQUAL: bool = false;

    #[inline(always)]
    fn of(&self, vertex: u32) -> f64 {
        self.weights[vertex as usize]
    }

    #[inline(always)]
    fn are_integers(&self) -> bool {
        self.are_integers
    }

    #[inline(always)]
    fn spread(&self) -> f64 {
        self.spread
    }
}

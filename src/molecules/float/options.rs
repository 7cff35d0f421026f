//! How the program of the thesis is run.

use spmesh_delaunay::order::{Curve, Sequence};

/// Options of [`triangulate`](super::triangulate).
#[derive(Debug, Clone, Copy)]
pub struct Options {
    /// The curve along which points are stored and inserted.
    pub curve: Curve,
    /// In which sequence they are inserted, within each level.
    pub sequence: Sequence,
    /// Whether points that have more low bits in common are inserted first.
    pub by_bit_levels: bool,
    /// Seed of the choices in walks.
    pub seed: u64,
    /// Whether every in-sphere test is compared with the exact sign: many times slower.
    pub check_signs: bool,
    /// Whether sphere equations are kept; they are computed for each test if not.
    pub cache_spheres: bool,
    /// Whether a walk takes orientations from the values of two spheres, not from determinants.
    pub orientation_from_spheres: bool,
}

/// The program of the thesis.
impl Default for Options {
    fn default() -> Options {
        Options {
            curve: Curve::Hilbert,
            sequence: Sequence::Pass,
            by_bit_levels: true,
            seed: 1,
            check_signs: false,
            cache_spheres: true,
            orientation_from_spheres: true,
        }
    }
}

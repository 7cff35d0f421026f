//! The bulk kernel in 3D: the canonical Delaunay tetrahedralization of an array of points.

mod tetrahedralization;

pub use tetrahedralization::{Corner, NONE, Tetrahedralization, Tetrahedron};

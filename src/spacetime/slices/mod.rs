//! Uses of a Delaunay diagram of space and time: simplices, interpolated values, slices at a time,
//! isosurfaces.
//!
//! `subdivide` splits cells into simplices. How it splits a face depends on the vertices of the face only, so
//! that the cells on both sides agree. So a function that is linear on the simplices is continuous
//! (`interpolate`), and the pieces that a hyperplane of constant time cuts from them fit together (`slice`,
//! `isosurface`).

mod faces;
mod interpolate;
mod isosurface;
mod slice;
mod subdivide;

pub use faces::Faces;
pub use interpolate::{Interpolator, Locator};
pub use isosurface::{Surface, isosurface};
pub use slice::{Slice, first_time, slice};
pub use subdivide::{Rule, Subdivision, subdivide};

/// The error message for points without values where values are needed.
pub const NO_VALUES: &str = "the points have no values to interpolate: give x y z t value";

//! What a Delaunay diagram of space and time is for: simplices, values between the points, and what there is
//! at a time.
//!
//! Everything rests on one subdivision of cells into simplices that is the same from both sides of a face,
//! because it depends on the vertices of the face only (`subdivide`). A function that is linear on the
//! simplices is then continuous (`interpolate`), and what a hyperplane of constant time cuts from them fits
//! together (`slice`, `isosurface`).

mod faces;
mod interpolate;
mod isosurface;
mod locate;
mod prism;
mod slice;
mod subdivide;

pub use faces::Faces;
pub use interpolate::Interpolator;
pub use isosurface::{Surface, isosurface};
pub use locate::Locator;
pub use slice::first_time;
pub use slice::{Slice, slice};
pub use subdivide::{Rule, Subdivision, subdivide};

/// What is said where values are needed and the points have none.
pub const NO_VALUES: &str = "the points have no values to interpolate: give x y z t value";

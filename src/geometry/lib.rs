//! Exact predicates, orders of insertion, and the Delaunay kernels of the plane and of space.

pub mod balls;
pub mod cell_lists;
pub mod cell_walk;
pub mod constrained2;
pub mod delaunay2;
pub mod delaunay3;
#[cfg(feature = "experiments")]
pub mod delaunay3_float;
mod location;
pub mod noding;
pub mod order;
pub mod polygons;
pub mod predicates;
#[cfg(target_arch = "x86_64")]
#[doc(hidden)]
pub mod processor;
mod vector;

pub use location::Location;

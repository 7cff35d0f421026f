//! Exact predicates, orders of insertion, and the Delaunay kernels of the plane, of space and of four
//! dimensions.

pub mod balls;
pub mod cell_lists;
pub mod cell_walk;
pub mod configurations;
pub mod constrained2;
pub mod delaunay2;
pub mod delaunay3;
#[cfg(feature = "experiments")]
pub mod delaunay3_float;
pub mod diagram4;
mod location;
pub mod noding;
pub mod order;
pub mod polygons;
pub mod predicates;
#[cfg(target_arch = "x86_64")]
mod processor;
pub mod spacetime;
mod vector;

pub use location::Location;

//! Unions of balls against slow and plain references.

mod balls;
#[cfg(feature = "experiments")]
mod float;
#[cfg(feature = "experiments")]
mod float_parts;
mod molecular_mesh;
mod parts;
mod pockets;
mod surface;
mod surfaces;
mod tiles;
mod vectors;

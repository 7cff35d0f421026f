//! Unions of balls against slow and plain references.

mod balls;
#[cfg(feature = "experiments")]
mod float;
mod pockets;
mod surface;
mod surfaces;
mod tiles;
mod vectors;

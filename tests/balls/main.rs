//! Unions of balls against slow and plain references.

mod balls;
mod pockets;
mod surface;
mod surfaces;
mod vectors;

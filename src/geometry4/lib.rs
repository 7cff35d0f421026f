//! Exact Delaunay diagrams of four dimensions, and their cells in space and time.

pub mod diagram4;
pub mod spacetime;

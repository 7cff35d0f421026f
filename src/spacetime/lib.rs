//! Exact Delaunay diagrams of four dimensions, and their cells in space and time.

pub mod dd4;
pub mod diagram4;
#[cfg(feature = "flags")]
pub mod flags;
pub mod slices;

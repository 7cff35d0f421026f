//! Configurations as streams: `formats/spmesh.md`, kind 8.

pub mod read;
pub mod write;

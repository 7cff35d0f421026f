//! Streaming Delaunay triangulation for point data too big or too degenerate for everything else.

pub use spmesh_core as core;
pub use spmesh_geometry as geometry;
pub use spmesh_model as model;
pub use spmesh_reduce as reduce;
pub use spmesh_stream as stream;

#[cfg(feature = "programs")]
pub use spmesh_cli as cli;

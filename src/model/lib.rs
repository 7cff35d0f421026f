//! Plain data that kernels, streams and tools share: points, boxes, cells, configurations, functions of splines.
//!
//! Nothing here reads, writes or decides; see `spmesh_stream` and `spmesh_geometry` for that.

pub mod bits;
pub mod bounds;
pub mod cells;
pub mod cells4;
pub mod configurations;
pub mod diagram4;
pub mod functions;
pub mod points;
pub mod simplex;

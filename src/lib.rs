//! Streaming Delaunay triangulation for point data too big or too degenerate for everything else.
//!
//! The tools in `bin/` are thin; everything they do is here. `ARCHITECTURE.md` has the module map.

pub mod audit;
pub mod bits;
pub mod bounds;
pub mod cell_grid;
mod cell_index;
pub mod cells;
pub mod cells4;
pub mod cli;
pub mod config;
pub mod configgen;
pub mod contours;
pub mod convert;
pub mod dd4;
pub mod delaunay2;
pub mod delaunay3;
pub mod delaunay3_float;
pub mod dem;
pub mod diagram4;
pub mod error;
pub mod finalize;
pub mod fit;
pub mod limits;
pub mod order;
pub mod output;
pub mod predicates;
mod prefetch;
mod random;
pub mod raster;
pub mod reduce;
pub mod sink;
pub mod source;
pub mod spacetime;
pub mod spline;
pub mod splinefit;
pub mod stream;
pub mod system;
mod temporary;
mod terrain;
pub mod tess3;
pub mod view;

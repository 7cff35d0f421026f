//! Streaming Delaunay triangulation for point data too big or too degenerate for everything else.
//!
//! The tools in `bin/` are thin; everything they do is here. `ARCHITECTURE.md` has the module map.

pub mod delaunay2;
pub mod error;
pub mod order;
pub mod predicates;

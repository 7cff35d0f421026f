//! The outline of a surface: which triangles of a mesh are inside.
//!
//! `limit` compares lengths of edges. `concave` finds the triangles inside of a concave outline while a stream
//! passes.

mod concave;
mod limit;

pub use concave::{ConcaveOutline, Inside, Waiting};
pub use limit::EdgeLimit;

//! What every crate of spmesh stands on: errors with positions, limits, files that appear only when complete,
//! the system.

pub mod error;
pub mod limits;
pub mod output;
pub mod parallel;
pub mod prefetch;
pub mod random;
pub mod system;
pub mod temporary;

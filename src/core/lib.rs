//! The base of all crates: errors with positions, limits, output files that appear only when complete,
//! threads, random numbers, and the operating system.

pub mod allocator;
pub mod error;
pub mod limits;
pub mod output;
pub mod parallel;
pub mod places;
pub mod prefetch;
pub mod random;
pub mod system;
pub mod temporary;
pub mod upstream;
pub mod wide;

//! The base of all crates: errors with positions, limits, output files that appear only when complete,
//! threads, random numbers, and the operating system.

#[cfg(feature = "files")]
pub mod allocator;
pub mod error;
pub mod limits;
#[cfg(feature = "files")]
pub mod output;
pub mod parallel;
#[cfg(feature = "files")]
pub mod places;
pub mod prefetch;
pub mod random;
#[cfg(feature = "files")]
pub mod system;
#[cfg(feature = "files")]
pub mod temporary;
#[cfg(feature = "files")]
pub mod upstream;
pub mod wide;

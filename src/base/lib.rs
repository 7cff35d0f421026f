//! The base of all crates but `delaunay`: errors with positions, limits, threads, random numbers; with the
//! feature `files` output files that appear only when complete and replace no input, temporary files, exit
//! codes along a pipe, and the operating system.

#[cfg(feature = "files")]
pub mod allocator;
pub mod error;
#[cfg(feature = "files")]
pub mod inputs;
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

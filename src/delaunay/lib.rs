#![doc = include_str!("README.md")]

pub mod batch;
mod bits;
pub mod cell_lists;
pub mod cell_tree;
mod cell_walk;
pub mod constrained2;
pub mod delaunay2;
pub mod delaunay3;
mod error;
mod location;
mod nearest;
pub mod network;
pub mod noding;
pub mod order;
pub mod parallel;
pub mod points;
pub mod predicates;
mod prefetch;
#[cfg(target_arch = "x86_64")]
#[doc(hidden)]
pub mod processor;
mod random;
#[cfg(feature = "serde")]
mod serialization;
pub mod simplex;
mod starts;
pub mod vector;
mod walk;
mod watch;

pub use error::{Error, Result};
pub use location::Location;
pub use starts::Starts;
pub use watch::Watch;

//! `tess3`: from structures to meshes and tables.

mod alpha;
#[cfg(feature = "experiments")]
mod experiments;
mod failures;
mod filtration;
mod meshes;
mod molecules;
mod selections;
mod sweeps;
mod tables;

//! `tess3`: structures in, meshes and tables out.

mod alpha;
#[cfg(feature = "experiments")]
mod experiments;
mod failures;
mod meshes;
mod molecules;
mod selections;
mod sweeps;
mod tables;

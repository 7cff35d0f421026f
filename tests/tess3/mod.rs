//! `tess3`: from structures to meshes and tables.

mod alpha;
mod assemblies;
mod balls;
mod classes;
mod failures;
mod filtration;
mod formats;
mod frames;
mod identity;
mod mesh;
mod meshes;
mod molecules;
mod parquet_reader;
mod parquet_values;
mod periodic;
mod pictures;
mod pipes;
mod selections;
mod sweeps;
mod tables;
mod weights;

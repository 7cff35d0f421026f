//! `tess3`: from structures to meshes and tables.

mod alpha;
mod assemblies;
mod balls;
mod classes;
mod experiments;
mod failures;
mod filtration;
mod formats;
mod frames;
mod identity;
mod joins;
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
mod sweeps_of_rows;
mod tables;
mod values;
mod weights;

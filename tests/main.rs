//! Integration tests: one crate, one module per subject.

mod allocation;
mod attributes;
mod audit;
mod bench;
mod canopy;
mod cli;
mod cluster;
mod cluster_windows;
mod contours;
mod convert;
mod dem;
mod formats;
mod ground;
mod height;
mod house;
mod like;
mod links;
mod manifest;
mod masks;
mod output;
mod pipelines;
mod point_rasters;
#[allow(dead_code, reason = "other test programs use more of it")]
mod programs;
mod raster;
mod raster_storage;
mod report;
mod simplify;
mod soak;
mod sources;
mod stream;
mod torture;
mod vectors;
mod view;
mod volumes;
mod weight;

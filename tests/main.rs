//! Integration tests: one crate, one module per subject.

mod allocation;
mod audit;
mod cell_grid;
mod cli;
mod configgen;
mod contours;
mod convert;
mod dd4;
mod dem;
mod finalize;
mod house;
mod links;
mod manifest;
mod output;
mod pipelines;
mod points4;
mod programs;
mod raster;
mod sources;
mod spacetime;
mod splinefit;
mod stream;
mod system;
mod tess3;
mod vectors;
mod view;

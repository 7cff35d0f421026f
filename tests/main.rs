//! Integration tests: one crate, one module per subject.

mod allocation;
mod audit;
mod cell_grid;
mod circle;
mod cli;
mod convert;
mod delaunay3_float;
mod finalize;
mod kernel;
mod kernel3;
mod kernel_predicates;
mod kernel_predicates3;
mod order;
mod output;
mod pipelines;
mod points4;
mod programs;
mod reduction;
mod reference;
mod sources;
mod spacetime;
mod stream;
mod system;
mod tess3;
mod vectors;

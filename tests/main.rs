//! Integration tests: one crate, one module per subject.

mod allocation;
mod audit;
mod circle;
mod convert;
mod finalize;
mod kernel;
mod kernel_predicates;
mod reduction;
mod reference;
mod sources;
mod stream;
mod vectors;

//! Integration tests: one crate, one module per subject.

mod circle;
mod finalize;
mod kernel;
mod kernel_predicates;
mod reduction;
mod reference;

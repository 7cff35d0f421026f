//! Integration tests: one crate, one module per subject.

mod kernel;
mod kernel_predicates;
mod reduction;
mod reference;

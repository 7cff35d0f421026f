//! Diagrams of four dimensions against slow and plain references.

mod diagram4;
mod faces;
mod quantum;
mod side;
mod sweep;

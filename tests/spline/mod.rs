//! Splines over configurations against their theory, and against evaluations of another kind.

mod reproduction;
mod sets;

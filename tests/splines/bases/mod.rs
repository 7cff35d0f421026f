//! Splines over configurations against their theory, and against evaluations of another kind.

mod alive;
mod derivatives;
mod domain;
mod raster;
mod rational;
mod reproduction;
mod sets;
mod simplex;
mod special;

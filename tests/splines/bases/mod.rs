//! Splines over configurations against their theory and independent evaluations.

mod alive;
mod derivatives;
mod directional_limit;
mod domain;
mod raster;
mod rational;
mod reproduction;
mod sets;
mod simplex;
mod special;

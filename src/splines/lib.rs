//! Bivariate splines over Delaunay configurations (thesis, chapters 6 to 8).
//!
//! [`bases`] evaluates bases of spline functions, their derivatives and whole rasters. [`fitting`] computes
//! coefficients and knots from data. [`configgen`] and [`splinefit`] are the engines of these programs;
//! `flags`, with the feature of this name, has their command lines.

pub mod bases;
pub mod configgen;
pub mod fitting;
#[cfg(feature = "flags")]
pub mod flags;
pub mod splinefit;

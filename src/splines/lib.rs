//! Bivariate splines over Delaunay configurations (thesis, chapters 6 to 8).
//!
//! [`bases`] evaluates bases of spline functions, their derivatives and whole rasters. [`fitting`] computes
//! coefficients and knots from data.

pub mod bases;
pub mod fitting;

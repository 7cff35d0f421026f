//! Bases of splines, and spline fits.

mod bases;
mod configgen;
mod fitting;
mod splinefit;

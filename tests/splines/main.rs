//! Bases of splines, and spline fits.

mod bases;
mod fitting;

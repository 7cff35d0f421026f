//! Bases of splines, and fits.

mod bases;
mod fitting;

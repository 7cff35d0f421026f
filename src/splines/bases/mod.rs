//! Bivariate splines over configurations (thesis 6.2 and chapter 8).
//!
//! [`simplex_spline`] evaluates single simplex splines of any degree, [`Basis`] all functions at a point that
//! [`spmesh_geometry::configurations`] makes of configurations: B-splines from links, and sums of them for
//! sharp features and box splines.
//!
//! `directional_limit` has the sides of lines that points lie on, `simplex` the recurrence, `linear_simplex`
//! closed forms of degrees 0 and 1, and `factors` what they are multiplied by; `elements` is the way from
//! configurations to simplex splines, `build` that to bases; `domain` knows where functions sum to one, and
//! `tree` finds what is alive.

mod basis;
mod build;
mod directional_limit;
mod domain;
mod elements;
mod factors;
mod function_sets;
mod jet;
mod linear_simplex;
mod raster;
mod simplex;
mod tree;

pub use basis::{Basis, Scratch};
pub use directional_limit::DirectionalLimit;
pub use jet::Jet;
pub use raster::{Raster, Row};
pub use simplex::{MAX_DEGREE, simplex_spline, simplex_spline_jet};

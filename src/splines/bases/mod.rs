//! Bases of bivariate splines over configurations (thesis 6.2 and chapter 8).
//!
//! [`simplex_spline`] evaluates one simplex spline of any degree. [`Basis`] evaluates all functions at a
//! point: B-splines, which come from links of configurations, and the sums of B-splines that
//! [`spmesh_configurations::special`] collects for sharp features and box splines.
//!
//! | file | what it does |
//! |---|---|
//! | `directional_limit` | decides the side of a line for points on the line |
//! | `simplex` | evaluates simplex splines by the recurrence |
//! | `linear_simplex` | closed forms of simplex splines of degrees 0 and 1, and their linear factors |
//! | `elements` | turns configurations into simplex splines with shares of functions |
//! | `build` | builds a basis from elements |
//! | `domain` | the region where functions sum to one, and functions with knots on one line |
//! | `tree` | finds the elements near a point |
//! | `raster` | evaluates splines row by row |

mod basis;
mod build;
mod directional_limit;
mod domain;
mod elements;
mod linear_simplex;
mod raster;
mod simplex;
mod tree;

pub(crate) use basis::Bend;
pub use basis::{Basis, Scratch};
pub use directional_limit::DirectionalLimit;
pub use raster::{Raster, Row};
pub use simplex::{Jet, MAX_DEGREE, simplex_spline, simplex_spline_jet};

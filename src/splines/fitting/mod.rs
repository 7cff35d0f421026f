//! Fitting of splines to observations.
//!
//! [`interpolate`] passes through values at Greville sites; everything else is least squares of scattered
//! [`Observations`], which are read as often as needed and never held: [`NormalEquations`] equations have the
//! size of the basis. [`Equations`] solves them, smoothed by an energy ([`bending`]) that is that of a thin
//! plate for the most part; `choice` finds out how much.
//!
//! [`robust()`] weighs observations by their residuals, so that gross errors do not count, and [`refine()`]
//! finds the knots, too.
//!
//! `observations` and `elevations` are what is fitted, `blocks` reads it in parallel, `rows` and `symmetric`
//! are matrices, `factor` is where they are factored, `trend` is what needs no solution, `energy` and
//! `control` are what smooths, with `polygon` and `overlaps`; `spread` has medians, `mesh` and `space` are
//! knots with what is over them, `places` says where knots go, and `triangle_residuals` what asks for them.

mod blocks;
mod cholesky;
mod control_energy;
mod cross_validation;
mod energy;
mod goal;
mod interpolation;
mod knot_placement;
mod mesh;
mod normal_equations;
mod observations;
mod overlaps;
mod polygon;
mod quantile_sketch;
mod refine;
mod residuals;
mod robust;
mod rows;
mod solve;
mod spline_space;
mod symmetric;
mod trend;
mod triangle_residuals;

pub use control_energy::{bending, control_bending};
pub use cross_validation::{Choice, Folds, Trial, degrees_of_freedom, generalised_cross_validation};
pub use energy::thin_plate;
pub use goal::{Goal, Round};
pub use interpolation::{Interpolation, interpolate};
pub use knot_placement::{KNOTS_MIN, grid_knots};
pub use mesh::Mesh;
pub use normal_equations::NormalEquations;
pub use observations::{Observation, ObservationReader, Observations};
pub use quantile_sketch::QuantileSketch;
pub use refine::{Refined, refine};
pub use residuals::{Residual, Summary, for_each_residual, summarise};
pub use robust::{Loss, RobustFit, robust, robust_from};
pub use solve::{Equations, Undetermined, least_squares};
pub use spline_space::SplineSpace;
pub use symmetric::Symmetric;

//! Fitting of splines to observations.
//!
//! [`interpolate`] passes through values at Greville sites; everything else is least squares of scattered
//! [`Observations`], which are read as often as needed and never held: [`Normal`] equations have the size of the basis.
//! [`Equations`] solves them, smoothed by an energy ([`bending`]) that is that of a thin plate for the most part; `choice` finds out
//! how much.
//!
//! [`robust()`] weighs observations by their residuals, so that gross errors do not count, and [`refine()`] finds the knots, too.
//!
//! `observations` and `elevations` are what is fitted, `blocks` reads it in parallel, `rows` and `symmetric` are matrices, `factor` is
//! where they are factored, `trend` is what needs no solution, `energy` and `control` are what smooths, with `polygon` and `overlaps`;
//! `spread` has medians, `mesh` and `cover` are knots with what is over them, `places` says where knots go, and `survey` what asks
//! for them.

mod blocks;
mod choice;
mod control;
mod cover;
mod energy;
mod factor;
mod mesh;
mod normal;
mod observations;
mod overlaps;
mod places;
mod polygon;
mod refine;
mod residuals;
mod robust;
mod rows;
mod sites;
mod solve;
mod spread;
mod survey;
mod symmetric;
mod trend;

pub use choice::{Choice, Folds, Trial, degrees_of_freedom, generalised_cross_validation};
pub use control::{bending, control_bending};
pub use cover::Cover;
pub use energy::thin_plate;
pub use mesh::Mesh;
pub use normal::Normal;
pub use observations::{Observation, ObservationReader, Observations};
pub use places::{KNOTS_MIN, even_places};
pub use refine::{Goal, Refined, Round, refine};
pub use residuals::{Residual, Summary, for_each_residual, summarise};
pub use robust::{Loss, RobustFit, robust, robust_from};
pub use sites::{Interpolation, interpolate};
pub use solve::{Equations, Undetermined, least_squares};
pub use spread::Spread;
pub use symmetric::Symmetric;

//! Fits of splines to observations.
//!
//! [`interpolate`] passes through values at Greville sites. All other fits are least squares of scattered
//! [`Observations`], which are read as often as needed and never held: [`NormalEquations`] have the size of
//! the basis. [`Equations`] solves them, smoothed by an energy ([`bending`]), which is mainly that of a thin
//! plate. [`choose`] and [`choose_robustly`] choose how much to smooth. [`robust()`] reduces the weight of
//! gross errors, and [`refine()`] also finds the knots.
//!
//! | files | what they hold |
//! |---|---|
//! | `blocks` | the data, and parallel passes over them |
//! | `normal_equations`, `symmetric`, `cholesky`, `solve` | equations, matrices and their solution |
//! | `least_energy` | functions that observations leave undetermined |
//! | `selected_inverse` | entries of inverses, for traces |
//! | `trend` | the linear part of a fit, which is solved on its own |
//! | `energy`, `cells`, `overlaps`, `polygon` | the thin-plate energy for smoothing, and that of control meshes |
//! | `membrane` | the membrane energy, and energies less those of planes |
//! | `choice`, `cross_validation`, `tension` | the choice of the smoothing parameters |
//! | `covariance` | how sure a fit is |
//! | `residuals`, `local_scale`, `robust` | residuals, their scales, and robust weights |
//! | `interpolation`, `project` | interpolation at Greville sites; a spline over other knots |
//! | `mesh` | triangulated knots, and the functions over them |
//! | `knot_placement`, `density`, `hull` | knots on grids, on grids that follow the density of observations, and along a border around them |
//! | `triangle_residuals`, `refine` | the search for knots |

mod blocks;
mod cells;
mod choice;
mod cholesky;
mod covariance;
mod cross_validation;
mod density;
mod energy;
mod hull;
mod interpolation;
mod knot_placement;
mod least_energy;
mod local_scale;
mod membrane;
mod mesh;
mod normal_equations;
mod overlaps;
mod polygon;
mod project;
mod refine;
mod residuals;
mod robust;
mod selected_inverse;
mod solve;
mod symmetric;
mod tension;
mod trend;
mod triangle_residuals;

pub use blocks::{Observation, ObservationReader, Observations};
pub use choice::{Choice, FailedTrial, Method, Trial};
pub use covariance::{Covariance, Recovered, recovered};
pub use cross_validation::{
    Folds, Quality, degrees_of_freedom, generalised_cross_validation, generalised_cross_validation_from,
    restricted_likelihood,
};
pub use density::{Density, Placement};
pub use energy::{bending, control_bending, thin_plate};
pub use hull::hull_corners;
pub use interpolation::{Interpolation, interpolate};
pub use knot_placement::{KNOTS_MIN, bounds, grid_knots};
pub use membrane::membrane;
pub use mesh::{Mesh, SplineSpace};
pub use normal_equations::{NormalEquations, domain_area};
pub use project::projected;
pub use refine::{Goal, Refined, Round, refine};
pub use residuals::{QuantileSketch, Residual, for_each_residual};
pub use robust::{Loss, RobustFit, RobustStart, robust, robust_on};
pub use solve::{Equations, Solution, Undetermined};
pub use symmetric::Symmetric;
pub use tension::{TENSIONS, Tense, choose, choose_robustly, choose_tension, with_tension};

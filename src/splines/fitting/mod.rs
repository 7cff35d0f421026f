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
//! | `observations`, `blocks` | the data, and parallel passes over them |
//! | `normal_equations`, `rows`, `symmetric`, `cholesky`, `solve` | equations, matrices and their solution |
//! | `least_energy` | functions that observations leave undetermined |
//! | `factor_blocks`, `selected_inverse` | entries of inverses, for traces |
//! | `trend` | the linear part of a fit, which is solved on its own |
//! | `energy`, `cells`, `overlaps`, `polygon` | the thin-plate energy for smoothing |
//! | `control_energy` | the energy of control meshes |
//! | `membrane`, `linear_part` | the membrane energy, and energies less those of planes |
//! | `choice`, `likelihood`, `cross_validation`, `tension`, `automatic` | the choice of the smoothing parameters |
//! | `residuals`, `quantile_sketch`, `local_scale`, `robust` | residuals, their scales, and robust weights |
//! | `interpolation` | interpolation at Greville sites |
//! | `mesh`, `spline_space` | triangulated knots, and the functions over them |
//! | `spacing`, `knot_placement` | knots on grids |
//! | `goal`, `triangle_residuals`, `refine` | the search for knots |

mod automatic;
mod blocks;
mod cells;
mod choice;
mod cholesky;
mod control_energy;
mod cross_validation;
mod energy;
mod factor_blocks;
mod goal;
mod interpolation;
mod knot_placement;
mod least_energy;
mod likelihood;
mod linear_part;
mod local_scale;
mod membrane;
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
mod selected_inverse;
mod solve;
mod spacing;
mod spline_space;
mod symmetric;
mod tension;
mod trend;
mod triangle_residuals;

pub use automatic::{choose, choose_robustly};
pub use choice::{Choice, FailedTrial, Method, Trial};
pub use control_energy::{bending, control_bending};
pub use cross_validation::{Folds, degrees_of_freedom, generalised_cross_validation};
pub use energy::thin_plate;
pub use goal::{Goal, Round};
pub use interpolation::{Interpolation, interpolate};
pub use knot_placement::{KNOTS_MIN, bounds, grid_knots};
pub use likelihood::restricted_likelihood;
pub use membrane::membrane;
pub use mesh::Mesh;
pub use normal_equations::NormalEquations;
pub use observations::{Observation, ObservationReader, Observations};
pub use quantile_sketch::QuantileSketch;
pub use refine::{Refined, refine};
pub use residuals::{Residual, Summary, for_each_residual, summarise};
pub use robust::{Loss, RobustFit, RobustStart, robust, robust_from, robust_on};
pub use solve::{Equations, Solution, Undetermined, least_squares};
pub use spacing::{Spacing, spacing};
pub use spline_space::SplineSpace;
pub use symmetric::Symmetric;
pub use tension::{TENSIONS, Tense, choose_tension, with_tension};

//! The engine of `splinefit`: fits splines to points in files, and evaluates splines.
//!
//! | files | what they do |
//! |---|---|
//! | `options`, `fit` | a fit from points and knots to coefficients, and its report |
//! | `points`, `elevations` | points of files as observations, in world or knot coordinates |
//! | `given_knots`, `breaklines`, `distinct_points` | knots from files, and features between them |
//! | `smoothing_choice` | the choice of the smoothing parameter |
//! | `frame`, `layout` | the coordinate frame of knots; knots with configurations and basis |
//! | `statistics`, `residual_lists` | residuals, as numbers and as lists |
//! | `extent` | the least and greatest value of a spline |
//! | `attributes`, `sites`, `values`, `raster`, `table` | values and derivatives, at sites and in cells |
//! | `collocation` | all functions at sites, as a sparse matrix |
//! | `summary`, `smoothness`, `jumps` | the domain, condition and smoothness of functions |
//! | `control` | control meshes |

mod attributes;
mod breaklines;
mod collocation;
mod control;
mod distinct_points;
mod elevations;
mod extent;
mod fit;
mod frame;
mod given_knots;
mod jumps;
mod layout;
mod options;
mod points;
mod raster;
mod residual_lists;
mod sites;
mod smoothing_choice;
mod smoothness;
mod statistics;
mod summary;
mod table;
mod values;

pub use attributes::Attribute;
pub use collocation::{CollocationCounts, write_collocation};
pub use control::ControlMesh;
pub use elevations::Elevations;
pub use extent::{EXCESS_MAX, Excess, Extent};
pub use fit::{Fitted, Report, Search, fit};
pub use frame::Frame;
pub use jumps::{Jump, Jumps};
pub use layout::{Layout, Spline};
pub use options::{Options, Smoothing};
pub use points::{Points, PointsInFrame};
pub use raster::{write_cell_array, write_raster, write_table};
pub use residual_lists::write_residuals;
pub use smoothing_choice::SmoothingChoice;
pub use smoothness::{Candidate, Smoothness};
pub use statistics::{PERCENTILES, Statistics};
pub use summary::{Condition, Summary};
pub use values::{write_value_array, write_values};

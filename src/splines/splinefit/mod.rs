//! The engine of `splinefit`: fits splines to points in files, and evaluates splines.
//!
//! | files | what they do |
//! |---|---|
//! | `options`, `fit` | a fit from points and knots to coefficients, and its report |
//! | `automatic` | knots that follow density and noise |
//! | `elevations`, `points`, `sites` | points of files as observations, in world or knot coordinates |
//! | `given_knots`, `breaklines` | knots from files, and features between them |
//! | `smoothing_choice` | the choice of the smoothing parameter |
//! | `anisotropy` | coordinates in which values vary alike in all directions |
//! | `frame`, `layout` | the coordinate frame of knots; knots with configurations and basis |
//! | `statistics` | residuals, as numbers and as lists |
//! | `certainty`, `validation` | standard errors, intervals and cross-validation |
//! | `extent` | the least and greatest value of a spline |
//! | `attributes`, `values`, `raster`, `table` | values and derivatives, at sites and in cells |
//! | `beyond` | limits other than the domain: a distance from points, extrapolation |
//! | `summary`, `smoothness` | the domain, condition and smoothness of functions |
//! | `control` | control meshes |

mod anisotropy;
mod attributes;
mod automatic;
mod beyond;
mod breaklines;
mod certainty;
mod control;
mod elevations;
mod extent;
mod fit;
mod frame;
mod given_knots;
mod layout;
mod options;
mod points;
mod raster;
mod sites;
mod smoothing_choice;
mod smoothness;
mod statistics;
mod summary;
mod table;
mod validation;
mod values;

pub use anisotropy::{Anisotropy, Stretch};
pub use attributes::Attribute;
pub use automatic::{Level, Levels, Stop};
pub use beyond::Beyond;
pub use certainty::Certainty;
pub use control::ControlMesh;
pub use elevations::Elevations;
pub use extent::{EXCESS_MAX, Excess, Extent};
pub use fit::{Fitted, Report, Search, fit};
pub use frame::Frame;
pub use layout::{Layout, Spline};
pub use options::{Options, Smoothing};
pub use points::{Points, PointsInFrame};
pub use raster::{write_cell_array, write_raster, write_table};
pub use smoothing_choice::SmoothingChoice;
pub use smoothness::{Candidate, Jump, Jumps, Smoothness};
pub use statistics::{PERCENTILES, Statistics, write_residuals};
pub use summary::{Condition, Summary};
pub use validation::{Prediction, Validated, Validation, validate};
pub use values::{CollocationCounts, write_collocation, write_value_array, write_values};

//! `splinefit`: points in, splines out; splines in, values out.
//!
//! `frame` says what coordinates mean, `layout` what splines are made over, with streams of both. `points`
//! are observations of their elevations, `given` knots of files, `sharp` breaklines among them, `options`
//! what is wanted; `choose` finds how much is smoothed, `fit` the coefficients, `statistics` and `lists` what
//! is left of points. `attributes` are what can be asked of a spline, `values` answers at sites, `raster` in
//! cells. `summary` says what functions are like, `smoothness` where they are less smooth than others, and
//! `control` has control meshes.

mod attributes;
mod breaklines;
mod control;
mod distinct_points;
mod elevations;
mod fit;
mod frame;
mod given_knots;
mod layout;
mod options;
mod points;
mod raster;
mod residual_lists;
mod smoothing_choice;
mod smoothness;
mod statistics;
mod summary;
mod values;

pub use attributes::Attribute;
pub use control::ControlMesh;
pub use elevations::Elevations;
pub use fit::{Fitted, Report, Search, fit};
pub use frame::Frame;
pub use layout::{Layout, Spline};
pub use options::{Options, Smoothing};
pub use points::{Points, PointsInFrame};
pub use raster::{write_raster, write_table};
pub use residual_lists::write_residuals;
pub use smoothing_choice::SmoothingChoice;
pub use smoothness::{Candidate, Smoothness};
pub use statistics::{PERCENTILES, Statistics};
pub use summary::{Condition, Summary};
pub use values::write_values;

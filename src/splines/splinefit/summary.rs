//! A summary of a layout: domain, condition and smoothness.

use super::layout::Layout;
use super::smoothness::Smoothness;
use crate::fitting::Interpolation;
use spmesh_base::error::Result;
use spmesh_formats::raster::Window;

/// Up to this number of functions, the condition is computed from singular values; beyond, it is estimated.
const EXACT_MAX: usize = 500;

/// A summary of a layout, in world coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Degree of functions.
    pub degree: usize,
    /// Number of knots.
    pub knots: usize,
    /// Number of distinct places of knots.
    pub places: usize,
    /// Number of functions.
    pub functions: usize,
    /// The box of all knots.
    pub bounds: Option<Window>,
    /// The box of the domain, if there is one.
    pub domain: Option<Window>,
    /// How well values at Greville sites determine a spline.
    pub condition: Condition,
    /// How smooth functions are, and where they are less smooth.
    pub smoothness: Smoothness,
}

/// The condition of the equations of interpolation at Greville sites.
#[derive(Debug, Clone, PartialEq)]
pub enum Condition {
    /// In the 2-norm.
    Exact(f64),
    /// A lower estimate in the 1-norm.
    Estimate(f64),
    /// The reason why there is none.
    None(String),
}

impl Summary {
    /// Summarises a layout, and the smoothness of the spline if there are coefficients.
    ///
    /// # Errors
    /// As [`Smoothness::of`].
    pub fn of(layout: &Layout, coefficients: Option<&[f64]>) -> Result<Summary> {
        let points = layout.knots.points().iter().map(|&stored| layout.frame.to_decimal(stored));
        let bounds = points.fold(None, |bounds: Option<Window>, point| {
            let Window { min, max } = bounds.unwrap_or(Window { min: point, max: point });
            let pick =
                |pick: fn(f64, f64) -> f64, from: [f64; 2]| [0, 1].map(|axis| pick(from[axis], point[axis]));
            Some(Window { min: pick(f64::min, min), max: pick(f64::max, max) })
        });
        Ok(Summary {
            degree: layout.basis.degree(),
            knots: layout.knots.len(),
            places: layout.places(),
            functions: layout.basis.len(),
            bounds,
            domain: layout.domain_window().ok(),
            condition: Condition::of(layout),
            smoothness: Smoothness::of(layout, coefficients)?,
        })
    }
}

impl Condition {
    fn of(layout: &Layout) -> Condition {
        let interpolation = match Interpolation::new(&layout.basis) {
            Ok(interpolation) => interpolation,
            Err(error) => return Condition::None(error.to_string()),
        };
        let exact = (layout.basis.len() <= EXACT_MAX).then(|| interpolation.condition_2()).flatten();
        exact.map_or_else(|| Condition::Estimate(interpolation.condition_1()), Condition::Exact)
    }
}

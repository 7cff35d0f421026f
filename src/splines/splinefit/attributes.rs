//! Attributes of a spline at a point: its value, and quantities that follow from its derivatives.

use crate::bases::Jet;
use spmesh_formats::raster::{aspect, slope};

/// An attribute of a spline at a point.
///
/// Aspect and both curvatures are NaN where a spline is level.
///
/// Source: Florinsky, "Digital Terrain Analysis", 2016, chapter 2, for the curvatures, which Evans, 1972, and
/// Shary, 1995, define, too: normal curvatures, positive where the surface is convex upwards.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Attribute {
    /// The value itself. Units: those of elevations.
    Value,
    /// The angle with the horizontal, in degrees.
    Slope,
    /// The direction of steepest descent, in degrees clockwise from north, from 0 to 360.
    Aspect,
    /// Curvature of the section along the steepest descent; flow accelerates where it is positive. Units: 1
    /// over the unit of coordinates.
    ProfileCurvature,
    /// Curvature of the section across the steepest descent; flow diverges where it is positive. Units: 1
    /// over the unit of coordinates.
    TangentialCurvature,
    /// The standard error of the value. Units: those of elevations.
    StandardError,
    /// The standard deviation of another point of weight one from the value. Units: those of elevations.
    PredictionError,
    /// The ends of the interval that holds 95 % of points of weight one. Units: those of elevations.
    Interval,
    /// The standard error of the slope. Units: degrees.
    SlopeError,
    /// Both derivatives, by x and by y. Units: those of elevations over those of coordinates.
    Gradient,
    /// The second derivatives, by xx, xy and yy. Units: those of elevations over the square of those of
    /// coordinates.
    Hessian,
}

impl Attribute {
    /// The names of its columns in tables.
    pub fn columns(self) -> &'static [&'static str] {
        match self {
            Attribute::Value => &["value"],
            Attribute::Slope => &["slope"],
            Attribute::Aspect => &["aspect"],
            Attribute::ProfileCurvature => &["profile_curvature"],
            Attribute::TangentialCurvature => &["tangential_curvature"],
            Attribute::StandardError => &["standard_error"],
            Attribute::PredictionError => &["prediction_error"],
            Attribute::Interval => &["lower", "upper"],
            Attribute::SlopeError => &["slope_error"],
            Attribute::Gradient => &["dx", "dy"],
            Attribute::Hessian => &["dxx", "dxy", "dyy"],
        }
    }

    /// Whether it needs the [`Certainty`](super::Certainty) of a spline.
    pub fn is_error(self) -> bool {
        matches!(
            self,
            Attribute::StandardError
                | Attribute::PredictionError
                | Attribute::Interval
                | Attribute::SlopeError
        )
    }

    /// Whether the attribute is a single number.
    pub fn is_single(self) -> bool {
        self.columns().len() == 1
    }

    /// The attribute at a point, or its first number if it has several, from a jet in world coordinates.
    pub fn of(self, jet: &Jet) -> f64 {
        let [p, q] = jet.gradient;
        let [r, s, t] = jet.hessian;
        let square = p * p + q * q;
        match self {
            Attribute::Value
            | Attribute::StandardError
            | Attribute::PredictionError
            | Attribute::Interval
            | Attribute::SlopeError => jet.value,
            Attribute::Gradient => p,
            Attribute::Hessian => r,
            Attribute::Slope => slope(jet.gradient),
            Attribute::Aspect => aspect(jet.gradient),
            // NaN where the square is zero.
            Attribute::ProfileCurvature => {
                -(p * p * r + 2.0 * p * q * s + q * q * t) / (square * (1.0 + square).powf(1.5))
            }
            Attribute::TangentialCurvature => {
                -(q * q * r - 2.0 * p * q * s + p * p * t) / (square * (1.0 + square).sqrt())
            }
        }
    }

    /// All numbers of the attribute at a point, in the order of columns.
    pub fn all(self, jet: &Jet) -> impl Iterator<Item = f64> {
        let others = match self {
            Attribute::Interval => &jet.gradient[..1],
            Attribute::Gradient => &jet.gradient[1..],
            Attribute::Hessian => &jet.hessian[1..],
            _ => &[],
        };
        [self.of(jet)].into_iter().chain(others.iter().copied())
    }

    /// Fills in all numbers of the attribute; NaN without a jet.
    pub(super) fn fill(self, jet: Option<&Jet>, numbers: &mut [f64]) {
        match jet {
            Some(jet) => numbers.iter_mut().zip(self.all(jet)).for_each(|(into, number)| *into = number),
            None => numbers.fill(f64::NAN),
        }
    }
}

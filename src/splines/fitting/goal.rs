//! When a search for knots stops, and what one round of it reached.

use super::knot_placement::KNOTS_MIN;
use super::robust::Loss;
use spmesh_base::error::{Error, Result};

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Greatest magnitude of residuals that is good enough. Units: those of values.
    pub tolerance: f64,
    /// Greatest number of places of knots; copies on the border do not count.
    pub max_knots: usize,
    /// The factor of the energy, in units of [`default_lambda`](super::NormalEquations::default_lambda). It
    /// must not be zero, so that the energy bridges gaps in the data.
    pub smoothing: f64,
    /// The loss function of a robust fit; `None` for least squares.
    pub loss: Option<Loss>,
}

impl Goal {
    /// A goal with the default smoothing, least squares, and these limits.
    pub fn new(tolerance: f64, max_knots: usize) -> Goal {
        Goal { tolerance, max_knots, smoothing: 1.0, loss: None }
    }

    /// Refuses goals out of range.
    pub(super) fn check(&self) -> Result<()> {
        if self.tolerance.is_nan() || self.tolerance <= 0.0 {
            return Err(Error::usage(format!("tolerance {}: expected a number above zero", self.tolerance)));
        }
        if self.max_knots < KNOTS_MIN {
            return Err(Error::usage(format!("{} knots: {KNOTS_MIN} are needed at least", self.max_knots)));
        }
        if !(self.smoothing > 0.0 && self.smoothing.is_finite()) {
            let what = format!("smoothing {}: expected a finite number above zero", self.smoothing);
            return Err(Error::usage(what));
        }
        Ok(())
    }
}

/// One round in numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Round {
    /// Places of knots.
    pub knots: usize,
    /// Functions.
    pub functions: usize,
    /// Greatest magnitude of residuals.
    pub greatest: f64,
    /// Root of the mean square of residuals.
    pub root_mean_square: f64,
    /// Number of residuals above the tolerance, without those of rejected observations.
    pub above: u64,
}

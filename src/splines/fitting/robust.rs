//! Robust fits: iteratively reweighted least squares, so that gross errors count little or not at all.

use super::normal_equations::{NormalEquations, Parts, Weighed};
use super::observations::Observations;
use super::quantile_sketch::QuantileSketch;
use super::residuals::{self, Residual};
use super::solve::{Equations, Solution};
use super::symmetric::Symmetric;
use crate::bases::Basis;
use spmesh_core::error::{Error, Result};
use std::num::NonZeroUsize;

/// Where Huber's loss becomes linear, in standard deviations; 95 % efficient for normal errors.
const HUBER: f64 = 1.345;
/// Where Tukey's loss becomes constant, in standard deviations; 95 % efficient, too. With either loss,
/// observations beyond are *rejected*.
const TUKEY: f64 = 4.685;
/// Standard deviations per median of magnitudes, for normal errors.
const DEVIATIONS: f64 = 1.482_602_218_505_602;
/// Least scale, relative to the root of the mean square of values: about the rounding error.
const SCALE_MIN: f64 = 1e-12;
/// The rounds end when the root of the mean square change of coefficients is at most this number of scales.
const CHANGE_MAX: f64 = 1e-2;
/// Added to errors that weights cause: with all observations, there was none.
pub(super) const LEFT_OUT: &str = "robust weights leave out the other observations";
/// Greatest number of rounds for one loss...
const ROUNDS_MAX: usize = 50;
/// ...and for fits to which knots will be added: coefficients may still change, but gross errors can be told
/// from other residuals.
pub(super) const ROUNDS_FEW: usize = 6;

/// The loss function of residuals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loss {
    /// Quadratic near zero, then linear. The loss is convex, so there is one best fit, but gross errors still
    /// pull it a little.
    Huber,
    /// Tukey's biweight: constant from 4.685 scales on, so that gross errors do not count at all. The
    /// iteration starts from Huber's fit.
    Tukey,
}

impl Loss {
    /// The factor of the weight of an observation whose residual is `scales` scales.
    fn factor(self, scales: f64) -> f64 {
        match self {
            Loss::Huber if scales <= HUBER => 1.0,
            Loss::Huber => HUBER / scales,
            Loss::Tukey if scales < TUKEY => (1.0 - (scales / TUKEY).powi(2)).powi(2),
            Loss::Tukey => 0.0,
        }
    }
}

/// A robust fit.
#[derive(Debug, Clone, PartialEq)]
pub struct RobustFit {
    /// Coefficients of the spline.
    pub coefficients: Vec<f64>,
    /// Standard deviation of an observation of weight one, from the median of the magnitudes of all
    /// residuals.
    pub scale: f64,
    /// Passes over the observations, including the pass for the normal equations.
    pub passes: usize,
    /// Whether the coefficients converged.
    pub has_converged: bool,
    /// Whether the last round solved its equations: see [`Solution::has_converged`].
    pub is_solved: bool,
}

/// Fits with a loss; `energy` is multiplied by `lambda`.
///
/// Cost: a pass and a factorisation per round, about 10 rounds per loss. Source: Holland and Welsch 1977.
///
/// # Errors
/// Those of [`NormalEquations::of`] and [`Equations::solve`]. Without smoothing, functions whose observations
/// are all rejected are not determined.
pub fn robust<O: Observations + ?Sized>(
    basis: &Basis,
    observations: &O,
    loss: Loss,
    energy: Option<&Symmetric>,
    lambda: f64,
    threads: NonZeroUsize,
) -> Result<RobustFit> {
    let plain = NormalEquations::of(basis, observations, threads)?;
    robust_from(&plain, basis, observations, loss, energy, lambda, threads)
}

/// [`robust()`] from known normal equations of all observations, which saves a pass.
///
/// # Errors
/// Those of [`robust()`].
pub fn robust_from<O: Observations + ?Sized>(
    plain: &NormalEquations,
    basis: &Basis,
    observations: &O,
    loss: Loss,
    energy: Option<&Symmetric>,
    lambda: f64,
    threads: NonZeroUsize,
) -> Result<RobustFit> {
    Rounds { basis, observations, energy, lambda, threads, most: ROUNDS_MAX }.fit(loss, plain)
}

impl RobustFit {
    /// Observations of weight one whose residual is greater are *rejected*.
    #[must_use]
    pub fn limit(&self) -> f64 {
        TUKEY * self.scale
    }

    /// Calls `visit` with all rejected observations, in order: those whose residual, times the root of the
    /// weight, is greater than 4.685 scales. Returns their number. One pass.
    ///
    /// # Errors
    /// Those of [`residuals::for_each_residual`].
    pub fn rejected<O: Observations + ?Sized>(
        &self,
        basis: &Basis,
        observations: &O,
        threads: NonZeroUsize,
        mut visit: impl FnMut(Residual),
    ) -> Result<u64> {
        let mut count = 0;
        residuals::for_each_residual(basis, &self.coefficients, observations, threads, |found| {
            if found.residual.abs() * found.weight.sqrt() > self.limit() {
                count += 1;
                visit(found);
            }
        })?;
        Ok(count)
    }
}

/// The inputs that all rounds share.
pub(super) struct Rounds<'a, O: ?Sized> {
    pub(super) basis: &'a Basis,
    pub(super) observations: &'a O,
    pub(super) energy: Option<&'a Symmetric>,
    pub(super) lambda: f64,
    pub(super) threads: NonZeroUsize,
    /// Greatest number of rounds for one loss.
    pub(super) most: usize,
}

impl<O: Observations + ?Sized> Rounds<'_, O> {
    /// Fits with a loss, from the normal equations of all observations.
    ///
    /// # Errors
    /// Those of [`robust()`].
    pub(super) fn fit(&self, loss: Loss, plain: &NormalEquations) -> Result<RobustFit> {
        let scale_min = scale_min(plain);
        let mut found = self.start(plain)?;
        if loss == Loss::Tukey {
            self.improve(&mut found, Loss::Tukey, scale_min)?;
        }
        Ok(found)
    }

    /// The fit with Huber's loss.
    ///
    /// # Errors
    /// Those of [`robust()`].
    pub(super) fn start(&self, plain: &NormalEquations) -> Result<RobustFit> {
        let Solution { coefficients, has_converged: is_solved } = self.solve(plain)?;
        let scale_min = scale_min(plain);
        let scale = self.scale(&coefficients, scale_min)?;
        let mut found = RobustFit { coefficients, scale, passes: 2, has_converged: false, is_solved };
        self.improve(&mut found, Loss::Huber, scale_min)?;
        Ok(found)
    }

    /// Iterates with one loss. Each round weighs observations by the scale that the previous round measured,
    /// and measures the scale for the next one.
    pub(super) fn improve(&self, fit: &mut RobustFit, loss: Loss, scale_min: f64) -> Result<()> {
        fit.has_converged = false;
        for _ in 0..self.most {
            let (parts, scale) = self.weighted(fit, loss, scale_min, 1, |_| 0)?;
            let normal = parts.sum(|_| true);
            let Solution { coefficients, has_converged: is_solved } =
                self.solve(&normal).map_err(|error| error.noting(LEFT_OUT))?;
            let squares = coefficients.iter().zip(&fit.coefficients).map(|(a, b)| (a - b) * (a - b));
            let change = (squares.sum::<f64>() / coefficients.len() as f64).sqrt();
            // While the scale still shrinks, coefficients have not converged, however slowly they change.
            let is_still = change <= CHANGE_MAX * scale.max(scale_min) && scale >= 0.98 * fit.scale;
            (fit.coefficients, fit.is_solved) = (coefficients, is_solved);
            fit.passes += 1;
            let is_least = fit.scale <= scale_min && scale <= scale_min;
            fit.scale = scale.max(scale_min);
            if is_still || is_least {
                fit.has_converged = true;
                return Ok(());
            }
        }
        Ok(())
    }

    /// The normal equations, weighted by residuals, in several parts; and the scale of the residuals.
    ///
    /// If residuals were rounding errors and are greater now, no observation keeps a weight. They are then
    /// weighed again by their own scale, within which half of them are.
    pub(super) fn weighted(
        &self,
        fit: &mut RobustFit,
        loss: Loss,
        scale_min: f64,
        count: usize,
        part_of: impl Fn(u64) -> usize + Sync,
    ) -> Result<(Parts, f64)> {
        let (parts, scale) = self.weighted_by_scale(fit, loss, count, &part_of)?;
        if parts.count() > 0 {
            return Ok((parts, scale));
        }
        fit.scale = scale.max(scale_min);
        fit.passes += 1;
        self.weighted_by_scale(fit, loss, count, &part_of)
    }

    fn weighted_by_scale(
        &self,
        fit: &RobustFit,
        loss: Loss,
        count: usize,
        part_of: impl Fn(u64) -> usize + Sync,
    ) -> Result<(Parts, f64)> {
        let mut sketch = QuantileSketch::default();
        let parts = Parts::of(
            self.basis,
            self.observations,
            self.threads,
            count,
            part_of,
            |_, observation, alive| {
                let residual = observation.value - residuals::value(&fit.coefficients, alive);
                let residual = residual * observation.weight.sqrt();
                let weight = observation.weight * loss.factor(residual.abs() / fit.scale);
                Weighed { weight, residual: (observation.weight > 0.0).then_some(residual) }
            },
            |residual| sketch.add(residual),
        )?;
        Ok((parts, scale_of(&sketch)?))
    }

    fn scale(&self, coefficients: &[f64], scale_min: f64) -> Result<f64> {
        let mut sketch = QuantileSketch::default();
        residuals::for_each_residual(self.basis, coefficients, self.observations, self.threads, |found| {
            if found.weight > 0.0 {
                sketch.add(found.residual * found.weight.sqrt());
            }
        })?;
        Ok(scale_of(&sketch)?.max(scale_min))
    }

    fn solve(&self, normal: &NormalEquations) -> Result<Solution> {
        Equations::new(self.basis, normal, self.energy)?.solution(self.lambda)
    }
}

/// The least scale: about the rounding error of values.
pub(super) fn scale_min(plain: &NormalEquations) -> f64 {
    (SCALE_MIN * (plain.square / plain.weight).sqrt()).max(f64::MIN_POSITIVE)
}

fn scale_of(sketch: &QuantileSketch) -> Result<f64> {
    let median = sketch.median().ok_or_else(|| Error::usage("no observations: nothing can be fitted"))?;
    Ok(DEVIATIONS * median)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fitting::{Observation, SplineSpace};

    #[test]
    fn some_observations_always_keep_a_weight() {
        let space = SplineSpace::of(vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]).expect("a space");
        let (basis, threads) = (&space.basis, NonZeroUsize::MIN);
        let at = |i: u32| [f64::from(i % 7) / 7.0, f64::from(i % 11) / 11.0];
        let observations: Vec<_> = (0..77).map(|i| Observation::new(at(i), 1.0 + f64::from(i % 3))).collect();
        let rounds =
            Rounds { basis, observations: &observations, energy: None, lambda: 0.0, threads, most: 1 };
        // All residuals are far beyond the scale, as if they had been rounding errors one round before.
        let zero = vec![0.0; basis.len()];
        let mut fit =
            RobustFit { coefficients: zero, scale: 1e-12, passes: 2, has_converged: false, is_solved: true };
        let (parts, scale) = rounds.weighted(&mut fit, Loss::Tukey, 1e-12, 1, |_| 0).expect("weights");
        assert_eq!((parts.count(), fit.passes), (77, 3));
        assert!((scale / (2.0 * DEVIATIONS) - 1.0).abs() < 0.01 && fit.scale == scale, "{scale}");
    }
}

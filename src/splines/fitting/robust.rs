//! Robust fits: iteratively reweighted least squares, so that gross errors count little or not at all.

use super::blocks::Observations;
use super::cholesky::Elimination;
use super::local_scale::{Cells, LocalScales, LocalSketch};
use super::normal_equations::{NormalEquations, Parts, Weighed};
use super::residuals::{self, QuantileSketch, Residual};
use super::solve::{Equations, Solution};
use super::symmetric::Symmetric;
use crate::bases::Basis;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::Point2;
use std::num::NonZeroUsize;
use std::sync::Arc;

/// Where Huber's loss becomes linear, in standard deviations; 95 % efficient for normal errors.
const HUBER: f64 = 1.345;
/// Where Tukey's loss becomes constant, in local standard deviations; 95 % efficient, too. With either loss,
/// observations beyond are *rejected*.
const TUKEY: f64 = 4.685;
/// Standard deviations per median of magnitudes, for normal errors.
const DEVIATIONS: f64 = 1.482_602_218_505_602;
/// Least scale, relative to the root of the mean square of values: about the rounding error.
const SCALE_MIN: f64 = 1e-12;
/// Weighted sums of squared residuals below this part of that of values may be rounding errors.
const SQUARE_MIN: f64 = 1e-13;
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
    /// The factor of the weight of an observation with this magnitude of its residual.
    fn factor(self, residual: f64, fit: &RobustFit, point: Point2) -> f64 {
        match self {
            Loss::Huber => (HUBER * fit.scale / residual).min(1.0),
            Loss::Tukey => {
                let part = (residual / fit.limit_at(point)).min(1.0);
                (1.0 - part * part).powi(2)
            }
        }
    }
}

/// A robust fit.
#[derive(Debug, Clone, PartialEq)]
pub struct RobustFit {
    /// Coefficients of the spline.
    pub coefficients: Vec<f64>,
    /// Standard deviation of an observation of weight one, from the median of the magnitudes of all
    /// residuals, and from how much of the errors the spline follows.
    pub scale: f64,
    /// Passes over the observations, including the pass for the normal equations.
    pub passes: usize,
    /// Whether the coefficients converged.
    pub has_converged: bool,
    /// Whether the last round solved its equations: see [`Solution::has_converged`].
    pub is_solved: bool,
    local: LocalScales,
}

/// A robust fit that is not finished: where other fits to the same observations start.
#[derive(Debug)]
pub struct RobustStart {
    pub(super) fit: RobustFit,
    /// The factor from the median of residuals to the scale, for the coefficients of the fit.
    inflation: f64,
    /// The least scale: about the rounding error of values.
    scale_min: f64,
    pub(super) elimination: Arc<Elimination>,
}

/// Fits with a loss, from the normal equations of all observations; `energy` is multiplied by `lambda`.
///
/// Cost: a pass and a factorisation per round, about 10 rounds per loss. Source: Holland and Welsch 1977.
///
/// # Errors
/// Those of [`Equations::solve`]. Without smoothing, functions whose observations are all rejected are not
/// determined.
pub fn robust<O: Observations + ?Sized>(
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

/// [`robust()`] from where a choice of `lambda` ended: see [`choose_robustly`](super::choose_robustly). The
/// basis, the observations and the energy are those of the choice.
///
/// # Errors
/// Those of [`robust()`].
pub fn robust_on<O: Observations + ?Sized>(
    mut start: RobustStart,
    basis: &Basis,
    observations: &O,
    loss: Loss,
    energy: Option<&Symmetric>,
    lambda: f64,
    threads: NonZeroUsize,
) -> Result<RobustFit> {
    Rounds { basis, observations, energy, lambda, threads, most: ROUNDS_MAX }.improve(&mut start, loss)?;
    Ok(start.fit)
}

impl RobustFit {
    /// Observations of weight one whose residual is greater are *rejected*, unless many residuals near them
    /// are great, too.
    pub fn limit(&self) -> f64 {
        TUKEY * self.scale
    }

    /// Whether an observation is rejected: its residual, times the root of the weight, is greater than 4.685
    /// local scales.
    pub fn is_rejected(&self, found: &Residual) -> bool {
        found.residual.abs() * found.weight.sqrt() > self.limit_at(found.point)
    }

    fn limit_at(&self, point: Point2) -> f64 {
        TUKEY * self.local.at(point, self.scale)
    }

    /// Calls `visit` with all rejected observations, in order: see [`RobustFit::is_rejected`]. Returns their
    /// number. One pass.
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
            if self.is_rejected(&found) {
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
    pub(super) fn fit(&self, loss: Loss, plain: &NormalEquations) -> Result<RobustFit> {
        let mut start = self.start(plain)?;
        if loss == Loss::Tukey {
            self.improve(&mut start, Loss::Tukey)?;
        }
        Ok(start.fit)
    }

    /// The fit with Huber's loss.
    pub(super) fn start(&self, plain: &NormalEquations) -> Result<RobustStart> {
        let equations = Equations::new(self.basis, plain, self.energy)?;
        let Solution { coefficients, has_converged: is_solved } = equations.solution(self.lambda)?;
        let inflation = self.inflation(plain, &coefficients);
        let scale_min = scale_min(plain);
        let scale = (inflation * self.median_scale(&coefficients)?).max(scale_min);
        let local = LocalScales::none(Cells::of(self.basis, plain.count));
        let fit = RobustFit { coefficients, scale, passes: 2, has_converged: false, is_solved, local };
        let mut start = RobustStart { fit, inflation, scale_min, elimination: equations.elimination() };
        self.improve(&mut start, Loss::Huber)?;
        Ok(start)
    }

    /// Iterates with one loss. Each round weighs observations by the scales that the previous round measured,
    /// and measures the scales for the next one.
    pub(super) fn improve(&self, start: &mut RobustStart, loss: Loss) -> Result<()> {
        start.fit.has_converged = false;
        for _ in 0..self.most {
            let Weighted { parts, scale, local } = self.weighted(start, loss, 1, |_| 0)?;
            let normal = parts.sum(|_| true);
            drop(parts);
            let Solution { coefficients, has_converged: is_solved } =
                self.solve(&normal, start).map_err(|error| error.noting(LEFT_OUT))?;
            start.inflation = self.inflation(&normal, &coefficients);
            let fit = &mut start.fit;
            let squares = coefficients.iter().zip(&fit.coefficients).map(|(a, b)| (a - b) * (a - b));
            let change = (squares.sum::<f64>() / coefficients.len() as f64).sqrt();
            // While the scale still shrinks, coefficients have not converged, however slowly they change.
            let is_still = change <= CHANGE_MAX * scale.max(start.scale_min) && scale >= 0.98 * fit.scale;
            let is_least = fit.scale <= start.scale_min && scale <= start.scale_min;
            (fit.coefficients, fit.is_solved, fit.local) = (coefficients, is_solved, local);
            fit.passes += 1;
            fit.scale = scale.max(start.scale_min);
            if is_still || is_least {
                fit.has_converged = true;
                return Ok(());
            }
        }
        Ok(())
    }

    /// The normal equations, weighted by residuals, in several parts; and the scales of the residuals.
    ///
    /// If residuals were rounding errors and are greater now, no observation keeps a weight. They are then
    /// weighed again by their own scale, within which half of them are.
    pub(super) fn weighted(
        &self,
        start: &mut RobustStart,
        loss: Loss,
        count: usize,
        part_of: impl Fn(u64) -> usize + Sync,
    ) -> Result<Weighted> {
        let weighted = self.weighted_by_scale(start, loss, count, &part_of)?;
        if weighted.parts.count() > 0 {
            return Ok(weighted);
        }
        start.fit.scale = weighted.scale.max(start.scale_min);
        start.fit.passes += 1;
        self.weighted_by_scale(start, loss, count, &part_of)
    }

    fn weighted_by_scale(
        &self,
        start: &RobustStart,
        loss: Loss,
        count: usize,
        part_of: impl Fn(u64) -> usize + Sync,
    ) -> Result<Weighted> {
        let RobustStart { fit, inflation, .. } = start;
        let cells = fit.local.cells();
        let (mut sketch, mut local) = (QuantileSketch::default(), LocalSketch::new(cells, fit.scale));
        let parts = Parts::of(
            self.basis,
            self.observations,
            self.threads,
            count,
            part_of,
            |_, observation, alive| {
                let residual = observation.value - residuals::value(&fit.coefficients, alive);
                let residual = residual * observation.weight.sqrt();
                let weight = observation.weight * loss.factor(residual.abs(), fit, observation.point);
                let seen = (residual, cells.at(observation.point));
                Weighed { weight, residual: (observation.weight > 0.0).then_some(seen) }
            },
            |(residual, cell)| {
                sketch.add(residual);
                local.add(cell, residual);
            },
        )?;
        Ok(Weighted { parts, scale: inflation * scale_of(&sketch)?, local: local.scales(cells) })
    }

    /// The scale that follows from the median of residuals alone.
    fn median_scale(&self, coefficients: &[f64]) -> Result<f64> {
        let mut sketch = QuantileSketch::default();
        residuals::for_each_residual(self.basis, coefficients, self.observations, self.threads, |found| {
            if found.weight > 0.0 {
                sketch.add(found.residual * found.weight.sqrt());
            }
        })?;
        scale_of(&sketch)
    }

    /// The ratio of errors to residuals, which are smaller as far as the spline follows errors.
    ///
    /// Let S be the weighted sum of squared residuals. If `lambda` is that of the greatest restricted
    /// likelihood, the variance of n errors is (S + `lambda` c'Ec) / n, whereas that of residuals is S / n.
    fn inflation(&self, normal: &NormalEquations, coefficients: &[f64]) -> f64 {
        let Some(energy) = self.energy.filter(|_| self.lambda > 0.0) else { return 1.0 };
        let square = normal.residual_square(coefficients);
        if square <= SQUARE_MIN * normal.square {
            return 1.0;
        }
        (1.0 + self.lambda * energy.form(coefficients).max(0.0) / square).sqrt()
    }

    fn solve(&self, normal: &NormalEquations, start: &RobustStart) -> Result<Solution> {
        let elimination = Some(Arc::clone(&start.elimination));
        Equations::eliminated(self.basis, normal, self.energy, elimination)?.solution(self.lambda)
    }
}

/// Normal equations in parts, weighted by residuals, and the scales of these.
pub(super) struct Weighted {
    pub(super) parts: Parts,
    scale: f64,
    local: LocalScales,
}

/// The least scale: about the rounding error of values.
fn scale_min(plain: &NormalEquations) -> f64 {
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
        let normal = NormalEquations::of(basis, &observations, threads).expect("equations");
        let mut start = rounds.start(&normal).expect("a fit");
        (start.fit.coefficients, start.fit.scale, start.fit.passes) = (zero, 1e-12, 2);
        start.fit.local = LocalScales::none(Cells::of(basis, 77));
        let Weighted { parts, scale, .. } =
            rounds.weighted(&mut start, Loss::Tukey, 1, |_| 0).expect("weights");
        assert_eq!((parts.count(), start.fit.passes), (77, 3));
        assert!((scale / (2.0 * DEVIATIONS) - 1.0).abs() < 0.01 && start.fit.scale == scale, "{scale}");
    }
}

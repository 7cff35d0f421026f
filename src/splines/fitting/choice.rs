//! The search for the smoothing parameter with the least score, whatever the score is.
//!
//! Scores can have several minima. The one at the least `lambda` is often false: where observations leave
//! gaps, a spline that follows each observation is not determined between them. So the search starts at the
//! `lambda` that the distance of observations suggests, and follows decreasing scores to the nearest
//! minimum. It never goes below a floor.

use super::solve::Equations;
use spmesh_base::error::{Error, Result};

/// Steps of the search, in the logarithm of `lambda` to base 10. After the last step, a parabola through the
/// three best trials gives the minimum.
const STEP: f64 = 0.5;
/// Steps from a `lambda` that is nearly the best one.
const STEP_NEAR: f64 = 0.25;
/// Accuracy of the best `lambda`, in its logarithm to base 10.
const TOLERANCE: f64 = 0.05;
/// The most steps in one direction.
const STEPS_MAX: usize = 24;
/// The most parabolas.
const PARABOLAS_MAX: usize = 3;

/// The least `lambda`, in units of the default one. It halves waves a bit longer than the distance of
/// observations, which is less than they can resolve.
const FLOOR: f64 = 0.1;
/// Scores are equal if their ratio, as that of likelihoods of all observations, is nearer to one.
const INDIFFERENCE: f64 = 0.01;

/// A `lambda` that was tried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trial {
    /// The factor of the energy.
    pub lambda: f64,
    /// The score, which is the less the better.
    pub score: f64,
}

/// A `lambda` without a score.
#[derive(Debug, Clone, PartialEq)]
pub struct FailedTrial {
    /// The factor of the energy.
    pub lambda: f64,
    /// Why it has no score.
    pub reason: String,
}

/// The `lambda` of the least score, and all that were tried.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// The best one.
    pub best: Trial,
    /// All trials with a score, in order of `lambda`.
    pub trials: Vec<Trial>,
    /// All trials without one, in order of `lambda`.
    pub failed: Vec<FailedTrial>,
    /// The floor: no lesser `lambda` was tried.
    pub least: f64,
}

impl Choice {
    /// Whether the floor is the best: the score suggests no smoothing, or even less.
    pub fn is_at_floor(&self) -> bool {
        self.best.lambda <= self.least * 10f64.powf(TOLERANCE)
    }
}

/// How `lambda` is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// By restricted maximum likelihood.
    Likelihood,
    /// By generalised cross-validation.
    Generalised,
    /// By cross-validation.
    Folds {
        /// Number of folds.
        count: usize,
        /// Seed of the division into folds.
        seed: u64,
    },
}

/// Where a search starts, and how far it goes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// The first `lambda`.
    pub(super) start: f64,
    /// The least one.
    pub(super) least: f64,
    /// The first step, in the logarithm of `lambda` to base 10.
    pub(super) step: f64,
    /// Scores that differ by a lesser part are equal.
    pub(super) indifference: f64,
}

impl Limits {
    /// The neutral element of [`Limits::both`].
    pub(super) const NONE: Limits = Limits { start: 0.0, least: 0.0, step: STEP, indifference: 0.0 };

    /// The limits for equations: they follow from the distance of observations.
    pub(super) fn of(equations: &Equations) -> Limits {
        let start = if equations.unit() > 0.0 { equations.default_lambda() } else { 0.0 };
        let indifference = INDIFFERENCE / equations.normal().count as f64;
        Limits { start, least: FLOOR * start, step: STEP, indifference }
    }

    /// The same limits for a search that starts close to its end.
    pub(super) fn near(self, lambda: Option<f64>) -> Limits {
        let Some(start) = lambda else { return self };
        Limits { start: start.max(self.least), step: STEP_NEAR, ..self }
    }

    /// The same limits in other units of weights.
    pub(super) fn over(self, part: f64) -> Limits {
        Limits { start: self.start / part, least: self.least / part, ..self }
    }

    /// The limits that hold for several equations.
    pub(super) fn both(self, other: Limits) -> Limits {
        let greater = |a: f64, b: f64| a.max(b);
        Limits {
            start: greater(self.start, other.start),
            step: self.step,
            least: greater(self.least, other.least),
            indifference: greater(self.indifference, other.indifference),
        }
    }
}

/// Searches for the least score.
pub(super) fn search(limits: Limits, score: impl FnMut(f64) -> Result<f64>) -> Result<Choice> {
    let Limits { start, least, .. } = limits;
    if !(start > 0.0 && start.is_finite()) {
        return Err(Error::usage("the energy of all functions is zero: there is nothing to choose"));
    }
    let mut walk = Walk { limits, score, trials: Vec::new(), failed: Vec::new(), error: None };
    walk.run();
    let Walk { mut trials, mut failed, error, .. } = walk;
    trials.sort_by(|a, b| a.lambda.total_cmp(&b.lambda));
    failed.sort_by(|a, b| a.lambda.total_cmp(&b.lambda));
    match trials.iter().min_by(|a, b| a.score.total_cmp(&b.score)) {
        Some(&best) => Ok(Choice { best, trials, failed, least }),
        None => Err(error.unwrap_or_else(|| Error::usage("no lambda has a score: use fewer knots"))),
    }
}

struct Walk<S> {
    limits: Limits,
    score: S,
    trials: Vec<Trial>,
    failed: Vec<FailedTrial>,
    error: Option<Error>,
}

impl<S: FnMut(f64) -> Result<f64>> Walk<S> {
    fn run(&mut self) {
        let step = self.limits.step;
        let middle = self.attempt(0.0);
        let floor = (self.limits.least / self.limits.start).log10().min(0.0);
        let up = self.attempt(step);
        let bracket = if self.is_less(up, middle) || !middle.is_finite() {
            self.follow([(0.0, middle), (step, up)], f64::INFINITY)
        } else {
            let below = (-step).max(floor);
            let down = if below < 0.0 { self.attempt(below) } else { f64::INFINITY };
            if self.is_less(down, middle) {
                self.follow([(0.0, middle), (below, down)], -floor)
            } else {
                [(below, down), (0.0, middle), (step, up)]
            }
        };
        self.refine(bracket, floor);
    }

    /// Follows decreasing scores, and returns the last three trials. `reach` is the greatest magnitude of
    /// exponents.
    fn follow(&mut self, [mut before, mut at]: [(f64, f64); 2], reach: f64) -> [(f64, f64); 3] {
        let sign = (at.0 - before.0).signum();
        for _ in 0..STEPS_MAX {
            let exponent = sign * (at.0.abs() + self.limits.step).min(reach);
            if exponent == at.0 {
                break;
            }
            let next = (exponent, self.attempt(exponent));
            if !self.is_less(next.1, at.1) {
                return [before, at, next];
            }
            (before, at) = (at, next);
        }
        [before, at, at]
    }

    /// Improves the middle of three trials by parabolas through them.
    fn refine(&mut self, mut bracket: [(f64, f64); 3], floor: f64) {
        for _ in 0..PARABOLAS_MAX {
            bracket.sort_by(|a, b| a.0.total_cmp(&b.0));
            let [left, middle, right] = bracket;
            let Some(lowest) = vertex(bracket).filter(|lowest| (left.0..=right.0).contains(lowest)) else {
                return;
            };
            let lowest = lowest.max(floor);
            if (lowest - middle.0).abs() < TOLERANCE {
                return;
            }
            let found = (lowest, self.attempt(lowest));
            bracket = match (found.1 < middle.1, lowest < middle.0) {
                (true, true) => [left, found, middle],
                (true, false) => [middle, found, right],
                (false, true) => [found, middle, right],
                (false, false) => [left, middle, found],
            };
        }
    }

    fn is_less(&self, a: f64, b: f64) -> bool {
        a < b - self.limits.indifference * b.abs()
    }

    /// The score of the start times a power of ten; infinity without one.
    fn attempt(&mut self, exponent: f64) -> f64 {
        let lambda = (self.limits.start * 10f64.powf(exponent)).max(self.limits.least);
        let error = match (self.score)(lambda) {
            Ok(score) if score.is_finite() => {
                self.trials.push(Trial { lambda, score });
                return score;
            }
            Ok(_) => Error::usage(
                "there are no more observations than effective coefficients: give more observations, or a \
                 number as --lambda",
            ),
            Err(error) => error,
        };
        self.failed.push(FailedTrial { lambda, reason: error.to_string() });
        self.error.get_or_insert(error);
        f64::INFINITY
    }
}

/// Where the parabola through three points has its minimum, if it has one.
fn vertex([(a, at_a), (b, at_b), (c, at_c)]: [(f64, f64); 3]) -> Option<f64> {
    let (left, right) = ((at_b - at_a) / (b - a), (at_c - at_b) / (c - b));
    let bend = (right - left) / (c - a);
    let lowest = 0.5 * (a + b) - 0.5 * left / bend;
    (bend > 0.0 && lowest.is_finite()).then_some(lowest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen(least: f64, score: impl Fn(f64) -> Result<f64>) -> Choice {
        search(Limits { start: 1.0, least, step: STEP, indifference: 1e-9 }, score).expect("a choice")
    }

    #[test]
    fn the_nearest_minimum_is_found() {
        for place in [-3.3, -0.2, 0.0, 0.1, 2.6, 7.0] {
            let choice = chosen(1e-9, |lambda| Ok(3.0 + (lambda.log10() - place).powi(2).sqrt().powi(3)));
            assert!((choice.best.lambda.log10() - place).abs() < 0.1, "{place}: {choice:?}");
            assert!(choice.failed.is_empty() && !choice.is_at_floor());
        }
        // A lesser minimum lies behind a rise.
        let choice = chosen(1e-9, |lambda| Ok((lambda.log10() - 1.0).powi(2).min(lambda.log10() + 8.0)));
        assert!((choice.best.lambda.log10() - 1.0).abs() < 0.1, "{choice:?}");
    }

    #[test]
    fn nothing_below_the_floor_is_tried() {
        let choice = chosen(0.02, |lambda| Ok(1.0 + lambda));
        assert!(choice.is_at_floor() && (choice.best.lambda / 0.02 - 1.0).abs() < 1e-12, "{choice:?}");
        assert!(choice.trials.iter().all(|trial| trial.lambda >= 0.02));
    }

    #[test]
    fn failed_trials_are_kept_with_their_reasons() {
        let fails = |lambda: f64| match lambda < 0.9 {
            true => Err(Error::usage("too little")),
            false => Ok((lambda.log10() + 3.0).powi(2)),
        };
        let choice = chosen(1e-9, fails);
        assert_eq!(choice.best.lambda, 1.0);
        assert!(choice.failed.len() == 1 && choice.failed[0].reason.contains("too little"), "{choice:?}");
        let limits = Limits { start: 1.0, least: 1e-9, step: STEP, indifference: 1e-9 };
        assert!(search(limits, |_| Err(Error::usage("none"))).is_err());
        assert!(search(limits, |_| Ok(f64::NAN)).is_err());
        assert!(search(Limits { start: 0.0, ..limits }, |_| Ok(1.0)).is_err());
    }
}

//! Choice of the smoothing parameter: generalised and k-fold cross-validation.

use super::cholesky::Factor;
use super::normal_equations::{NormalEquations, Parts};
use super::observations::Observations;
use super::solve::Equations;
use super::symmetric::Symmetric;
use crate::bases::Basis;
use spmesh_core::error::{Error, Result};
use spmesh_core::random::Random;
use std::num::NonZeroUsize;

/// Up to this number of functions, traces are exact.
const EXACT_MAX: usize = 256;
/// Random vectors for the estimate of a trace; the relative error is then about a percent.
const PROBES: usize = 24;
/// The first trials: powers of ten times [`Equations::unit`], with exponents from `LEAST` to `-LEAST` in
/// steps of `STEP`. The range is this wide because planes bend so much less than functions that they take a
/// great factor.
const LEAST: f64 = -9.0;
const STEP: f64 = 1.5;
/// Accuracy of the best `lambda`, in its logarithm to base 10.
const TOLERANCE: f64 = 0.05;

/// A `lambda` that was tried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trial {
    /// The factor of the energy.
    pub lambda: f64,
    /// An estimate of the weighted mean square error at observations that were not used.
    pub score: f64,
}

/// The `lambda` of the least score, and all that were tried.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// The best one.
    pub best: Trial,
    /// All trials, in order of `lambda`, except those that leave functions undetermined.
    pub trials: Vec<Trial>,
}

/// Chooses by generalised cross-validation: the least (S / n) / (1 - t / n)^2, for n observations, the
/// weighted sum S of squared residuals, and the trace t of the smoothing matrix.
///
/// For more than 256 functions, the trace is estimated with random vectors (Hutchinson 1990), which `seed`
/// determines. For fewer functions it is exact.
///
/// Cost: about 25 factorisations. Source: Craven and Wahba 1979.
///
/// # Errors
/// Those of [`Equations::solve`], if it fails for every `lambda`.
pub fn generalised_cross_validation(equations: &Equations, seed: u64) -> Result<Choice> {
    let normal = equations.normal();
    search(equations.unit(), |lambda| {
        equations.with_factor(lambda, |factor| {
            equations.check(factor, lambda)?;
            let coefficients = equations.coefficients(factor);
            let count = normal.count as f64;
            let free = 1.0 - trace(factor, &normal.matrix, seed) / count;
            let score = normal.residual_square(&coefficients) / count / (free * free);
            Ok(if free > 0.0 { score } else { f64::INFINITY })
        })
    })
}

/// The effective number of parameters for a `lambda`: the trace of the smoothing matrix.
///
/// Accuracy: exact up to 256 functions, about a percent above.
///
/// # Errors
/// Those of [`Equations::solve`].
pub fn degrees_of_freedom(equations: &Equations, lambda: f64, seed: u64) -> Result<f64> {
    equations.with_factor(lambda, |factor| {
        equations.check(factor, lambda)?;
        Ok(trace(factor, &equations.normal().matrix, seed))
    })
}

/// The trace of F^-1 N, for the factored matrix F and the matrix N of the normal equations.
fn trace(factor: &Factor, matrix: &Symmetric, seed: u64) -> f64 {
    let count = matrix.len();
    if count <= EXACT_MAX {
        let of_function = |function: usize| {
            let mut unit = vec![0.0; count];
            unit[function] = 1.0;
            factor.solve(&matrix.times(&unit))[function]
        };
        return (0..count).map(of_function).sum();
    }
    let mut random = Random::new(seed);
    let mut probe = || {
        let signs: Vec<f64> = (0..count).map(|_| if random.bits() >> 63 == 0 { 1.0 } else { -1.0 }).collect();
        let smoothed = factor.solve_once(&matrix.times(&signs));
        smoothed.iter().zip(&signs).map(|(value, sign)| value * sign).sum::<f64>()
    };
    (0..PROBES).map(|_| probe()).sum::<f64>() / PROBES as f64
}

/// Observations in folds, to be left out one fold at a time.
#[derive(Debug)]
pub struct Folds {
    /// For each fold, the equations of all other folds, and its own.
    problems: Vec<(NormalEquations, NormalEquations)>,
    weight: f64,
}

impl Folds {
    /// Divides observations into folds, by their numbers and a seed, in one pass.
    ///
    /// Memory: that of two sets of normal equations for each fold.
    ///
    /// # Errors
    /// Fewer than two folds; a fold without observations; those of [`NormalEquations::of`].
    pub fn of<O: Observations + ?Sized>(
        basis: &Basis,
        observations: &O,
        folds: usize,
        seed: u64,
        threads: NonZeroUsize,
    ) -> Result<Folds> {
        if folds < 2 {
            return Err(Error::usage(format!("{folds} folds: cross-validation needs two at least")));
        }
        let fold_of = |index: u64| Random::new(seed ^ index.rotate_left(32)).below(folds as u64) as usize;
        let parts = Parts::unweighed(basis, observations, threads, folds, fold_of)?;
        let problems: Vec<(NormalEquations, NormalEquations)> =
            (0..folds).map(|out| (parts.sum(|fold| fold != out), parts.sum(|fold| fold == out))).collect();
        parts.sum(|_| true).check()?;
        if let Some(empty) = problems.iter().position(|(_, left_out)| left_out.count == 0) {
            let what = format!("fold {empty} of {folds} has no observation: use fewer folds");
            return Err(Error::usage(what));
        }
        let weight = problems.iter().map(|(_, left_out)| left_out.weight).sum();
        Ok(Folds { problems, weight })
    }

    /// Chooses the `lambda` that predicts folds best from the others, by the weighted mean square error.
    ///
    /// Cost: about 25 factorisations per fold. Accuracy of scores: about 1e-15 of the mean square of values.
    ///
    /// # Errors
    /// Those of [`Equations::solve`], if it fails for every `lambda`.
    pub fn choose(&self, basis: &Basis, energy: &Symmetric) -> Result<Choice> {
        let equations: Vec<Equations> = self
            .problems
            .iter()
            .map(|(kept, _)| Equations::new(basis, kept, Some(energy)))
            .collect::<Result<_>>()?;
        // In units of all observations: without one fold, weights and lambda are scaled down alike.
        let unit = equations.iter().map(Equations::unit).sum::<f64>() / (equations.len() - 1) as f64;
        search(unit, |lambda| {
            let mut sum = 0.0;
            for (equations, (kept, left_out)) in equations.iter().zip(&self.problems) {
                let part = kept.weight / self.weight;
                sum += left_out.residual_square(&equations.solve(lambda * part)?);
            }
            Ok(sum / self.weight)
        })
    }
}

/// The least score: by coarse steps first, then by golden sections around the best step.
fn search(unit: f64, mut score: impl FnMut(f64) -> Result<f64>) -> Result<Choice> {
    if unit <= 0.0 {
        return Err(Error::usage("the energy of all functions is zero: there is nothing to choose"));
    }
    let mut trials = Vec::new();
    let mut failed = None;
    let mut attempt = |exponent: f64| -> f64 {
        let lambda = unit * 10f64.powf(exponent);
        match score(lambda) {
            Ok(score) if score.is_finite() => {
                trials.push(Trial { lambda, score });
                score
            }
            Ok(_) => f64::INFINITY,
            Err(error) => {
                failed.get_or_insert(error);
                f64::INFINITY
            }
        }
    };
    let steps = (-2.0 * LEAST / STEP) as i32;
    let coarse = (0..=steps).map(|step| LEAST + STEP * f64::from(step));
    let tried: Vec<(f64, f64)> = coarse.map(|exponent| (exponent, attempt(exponent))).collect();
    let best = tried.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).filter(|best| best.1.is_finite());
    if let Some((middle, _)) = best {
        golden_section(middle - STEP, middle + STEP, &mut attempt);
    }
    trials.sort_by(|a, b| a.lambda.total_cmp(&b.lambda));
    match trials.iter().min_by(|a, b| a.score.total_cmp(&b.score)) {
        Some(&best) => Ok(Choice { best, trials }),
        None => Err(failed.unwrap_or_else(|| {
            Error::usage("observations are not more than coefficients for any lambda: use fewer knots")
        })),
    }
}

/// Looks for a minimum between two numbers (Kiefer 1953).
fn golden_section(mut from: f64, mut to: f64, attempt: &mut impl FnMut(f64) -> f64) {
    let part = (5f64.sqrt() - 1.0) / 2.0;
    let (mut low, mut high) = (to - part * (to - from), from + part * (to - from));
    let (mut at_low, mut at_high) = (attempt(low), attempt(high));
    while to - from > 2.0 * TOLERANCE {
        if at_low <= at_high {
            (to, high, at_high) = (high, low, at_low);
            low = to - part * (to - from);
            at_low = attempt(low);
        } else {
            (from, low, at_low) = (low, high, at_high);
            high = from + part * (to - from);
            at_high = attempt(high);
        }
    }
}

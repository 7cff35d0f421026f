//! Fits whose smoothing parameter is chosen, with or without robust weights.
//!
//! Gross errors look like noise: with them, every method smooths too much, or follows them. And which
//! observations are gross errors depends on how much is smoothed. So robust fits alternate: weights for the
//! current `lambda`, then the best `lambda` for the weighted equations. The weights are always those of
//! Tukey's loss, which leaves gross errors out. With Huber's loss, they would still count as noise.

use super::choice::{Choice, Method};
use super::cross_validation::{Folds, fold_of, generalised_cross_validation};
use super::likelihood::restricted_likelihood;
use super::normal_equations::{NormalEquations, Parts};
use super::observations::Observations;
use super::robust::{LEFT_OUT, Loss, ROUNDS_FEW, Rounds, scale_min};
use super::solve::Equations;
use super::symmetric::Symmetric;
use crate::bases::Basis;
use spmesh_core::error::{Error, Result};
use std::num::NonZeroUsize;

/// Most alternations of weights and `lambda`.
const ALTERNATIONS_MAX: usize = 6;
/// The alternation ends when `lambda` changes by less than this factor: halved waves then differ by 5 %.
const CHANGE_MAX: f64 = 1.25;

/// Chooses `lambda` for all observations with their own weights.
///
/// # Errors
/// Those of the method.
pub fn choose<O: Observations + ?Sized>(
    plain: &NormalEquations,
    basis: &Basis,
    observations: &O,
    energy: &Symmetric,
    method: Method,
    threads: NonZeroUsize,
) -> Result<Choice> {
    match method {
        Method::Folds { count, seed } => {
            Folds::of(basis, observations, count, seed, threads)?.choose(basis, energy)
        }
        _ => of_equations(&Equations::new(basis, plain, Some(energy))?, method),
    }
}

/// Chooses `lambda` with robust weights, from the normal equations of all observations.
///
/// The choice is that of the last alternation, with the failed trials of all of them.
///
/// Cost: a few passes for each alternation, of which two or three are usual, and its choice.
///
/// # Errors
/// Those of the method and of [`robust()`](super::robust()).
pub fn choose_robustly<O: Observations + ?Sized>(
    plain: &NormalEquations,
    basis: &Basis,
    observations: &O,
    energy: &Symmetric,
    method: Method,
    threads: NonZeroUsize,
) -> Result<Choice> {
    let (lambda, least) = (plain.default_lambda(basis), scale_min(plain));
    let mut rounds = Rounds { basis, observations, energy: Some(energy), lambda, threads, most: ROUNDS_FEW };
    let mut fit = rounds.start(plain)?;
    let (mut alternation, mut failed) = (0, Vec::new());
    loop {
        rounds.improve(&mut fit, Loss::Tukey, least)?;
        let (parts, _) = match method {
            Method::Folds { count, seed } => {
                rounds.weighted(&mut fit, Loss::Tukey, least, count, |index| fold_of(index, count, seed))?
            }
            _ => rounds.weighted(&mut fit, Loss::Tukey, least, 1, |_| 0)?,
        };
        let noted = |error: Error| if parts.count() < plain.count { error.noting(LEFT_OUT) } else { error };
        let mut choice = of_parts(&parts, basis, energy, method).map_err(noted)?;
        failed.append(&mut choice.failed);
        let change = (choice.best.lambda / rounds.lambda).ln().abs();
        alternation += 1;
        if change < CHANGE_MAX.ln() || alternation == ALTERNATIONS_MAX {
            failed.sort_by(|a, b| a.lambda.total_cmp(&b.lambda));
            return Ok(Choice { failed, ..choice });
        }
        rounds.lambda = choice.best.lambda;
    }
}

fn of_parts(parts: &Parts, basis: &Basis, energy: &Symmetric, method: Method) -> Result<Choice> {
    match method {
        Method::Folds { count, .. } => Folds::of_parts(parts, count)?.choose(basis, energy),
        _ => of_equations(&Equations::new(basis, &parts.sum(|_| true), Some(energy))?, method),
    }
}

fn of_equations(equations: &Equations, method: Method) -> Result<Choice> {
    match method {
        Method::Generalised => generalised_cross_validation(equations),
        _ => restricted_likelihood(equations),
    }
}

//! Fits whose smoothing parameter is chosen, with or without robust weights.
//!
//! Gross errors look like noise: with them, every method smooths too much, or follows them. And which
//! observations are gross errors depends on how much is smoothed. So robust fits alternate: weights for the
//! current `lambda`, then the best `lambda` for the weighted equations. The weights are always those of
//! Tukey's loss, which leaves gross errors out. With Huber's loss, they would still count as noise.

use super::choice::{Choice, Method};
use super::cholesky::Elimination;
use super::cross_validation::{Folds, cross_validation_near, fold_of};
use super::likelihood::likelihood_near;
use super::normal_equations::{NormalEquations, Parts};
use super::observations::Observations;
use super::robust::{LEFT_OUT, Loss, RobustStart, Rounds};
use super::solve::Equations;
use super::symmetric::Symmetric;
use crate::bases::Basis;
use spmesh_base::error::{Error, Result};
use std::num::NonZeroUsize;
use std::sync::Arc;

/// Most alternations of weights and `lambda`.
const ALTERNATIONS_MAX: usize = 6;
/// Most rounds of weights before the first one, with Huber's loss...
const ROUNDS_FIRST: usize = 4;
/// ...and before each one, with Tukey's. Coefficients need not converge before `lambda` has.
const ROUNDS_EACH: usize = 2;
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
        _ => of_equations(&Equations::new(basis, plain, Some(energy))?, method, None),
    }
}

/// Chooses `lambda` with robust weights, from the normal equations of all observations. Also returns the fit
/// of the last weights, from which [`robust_on`](super::robust_on) continues.
///
/// The choice is that of the last alternation, with the failed trials of all of them. All alternations but
/// the first search close to the `lambda` that the one before has found.
///
/// Cost: about 25 factorisations of one order of elimination, and ten passes.
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
) -> Result<(Choice, RobustStart)> {
    let lambda = plain.default_lambda(basis);
    let most = ROUNDS_FIRST;
    let mut rounds = Rounds { basis, observations, energy: Some(energy), lambda, threads, most };
    let mut start = rounds.start(plain)?;
    rounds.most = ROUNDS_EACH;
    let (mut near, mut failed) = (None, Vec::new());
    for alternation in 1.. {
        rounds.improve(&mut start, Loss::Tukey)?;
        let parts = match method {
            Method::Folds { count, seed } => {
                rounds.weighted(&mut start, Loss::Tukey, count, |index| fold_of(index, count, seed))?.parts
            }
            _ => rounds.weighted(&mut start, Loss::Tukey, 1, |_| 0)?.parts,
        };
        let noted = |error: Error| if parts.count() < plain.count { error.noting(LEFT_OUT) } else { error };
        let elimination = Arc::clone(&start.elimination);
        let mut choice = of_parts(&parts, basis, energy, method, near, elimination).map_err(noted)?;
        failed.append(&mut choice.failed);
        let change = (choice.best.lambda / rounds.lambda).ln().abs();
        if change < CHANGE_MAX.ln() || alternation == ALTERNATIONS_MAX {
            failed.sort_by(|a, b| a.lambda.total_cmp(&b.lambda));
            return Ok((Choice { failed, ..choice }, start));
        }
        rounds.lambda = choice.best.lambda;
        near = Some(rounds.lambda);
    }
    unreachable!("the last alternation returns")
}

fn of_parts(
    parts: &Parts,
    basis: &Basis,
    energy: &Symmetric,
    method: Method,
    near: Option<f64>,
    elimination: Arc<Elimination>,
) -> Result<Choice> {
    if let Method::Folds { count, .. } = method {
        return Folds::of_parts(parts, count)?.choose_near(basis, energy, near, Some(elimination));
    }
    let normal = parts.sum(|_| true);
    let equations = Equations::eliminated(basis, &normal, Some(energy), Some(elimination))?;
    of_equations(&equations, method, near)
}

fn of_equations(equations: &Equations, method: Method, near: Option<f64>) -> Result<Choice> {
    match method {
        Method::Generalised => cross_validation_near(equations, near),
        _ => likelihood_near(equations, near),
    }
}

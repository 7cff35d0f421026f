//! The choice of the smoothing parameter for a fit, and of a tension.
//!
//! Thin plates are smooth; ground with steps and banks is less so. The energy of a spline in tension is the
//! thin-plate energy plus t^2 times the membrane energy. Waves longer than 2 pi / t are those of a membrane,
//! which bends at observations. Tensions are compared by their likelihood, which holds for observations,
//! whatever the energy is.
//!
//! Gross errors look like noise: with them, every method smooths too much, or follows them. And which
//! observations are gross errors depends on how much is smoothed. So robust fits alternate: weights for the
//! current `lambda`, then the best `lambda` for the weighted equations. The weights are always those of
//! Tukey's loss, which leaves gross errors out. With Huber's loss, they would still count as noise.

use std::num::NonZeroUsize;
use std::sync::Arc;

use super::blocks::Observations;
use super::choice::{Choice, Limits, Method};
use super::cholesky::Elimination;
use super::cross_validation::{
    Folds, Likelihood, fold_of, generalised_cross_validation, restricted_likelihood,
};
use super::membrane::membrane;
use super::normal_equations::{NormalEquations, Parts};
use super::robust::{LEFT_OUT, Loss, RobustStart, Rounds};
use super::solve::Equations;
use super::symmetric::Symmetric;
use crate::bases::Basis;
use spmesh_base::error::{Error, Result};

/// Tensions that suit terrain. Waves longer than six distances of observations have mainly the energy of a
/// membrane with the second, and waves longer than three with the third.
pub const TENSIONS: [f64; 3] = [0.0, 1.0, 2.0];

/// The least `lambda` of the likelihood, in units of the default one, if the typical distance of observations
/// is known: where they are denser, they tell more.
const FLOOR: f64 = 1e-3;

/// An energy with its tension.
#[derive(Debug)]
pub struct Tense {
    /// The tension, in units of one over the distance of observations.
    pub tension: f64,
    /// The matrix of the energy.
    pub energy: Symmetric,
    /// The choice of `lambda` for it.
    pub choice: Choice,
}

/// Chooses a tension and `lambda` by restricted maximum likelihood, for the energy `bending` of a thin plate.
/// Tensions are tried in the given order, while they become likelier. If there is one only, `lambda` alone is
/// chosen.
///
/// Cost: about seven factorisations for each tension that is tried.
///
/// # Errors
/// No tension, or one that is negative or not finite; those of
/// [`restricted_likelihood`] and [`membrane`].
pub fn choose_tension(
    basis: &Basis,
    normal: &NormalEquations,
    bending: Symmetric,
    tensions: &[f64],
) -> Result<Tense> {
    let (mut likelihood, area) = (Likelihood::default(), normal.area_per_observation(basis));
    let plain = Limits::of(&Equations::new(basis, normal, Some(&bending))?);
    let plain = match normal.distance {
        Some(_) => Limits { least: FLOOR * plain.start, ..plain },
        None => plain,
    };
    let (mut best, mut of_plate, mut slopes) = (None::<Tense>, plain.start, None);
    for &tension in tensions {
        check(tension)?;
        let energy = match (tension > 0.0, &mut slopes) {
            (false, _) => bending.clone(),
            (true, Some(slopes)) => tensed(&bending, slopes, tension, area),
            (true, none) => tensed(&bending, none.insert(membrane(basis)?), tension, area),
        };
        let equations = equations(basis, normal, &energy, tension)?;
        // The square of the wave number that a plate halves, times the area of an observation.
        let halved = (normal.weight * area / of_plate / normal.count as f64).sqrt();
        // This start halves the same waves.
        let start = (of_plate / (1.0 + tension * tension / halved)).max(plain.least);
        let limits = Limits { start, ..plain };
        let choice = match tensions.len() {
            1 => likelihood.of_one(&equations, limits)?,
            _ => likelihood.choose(&equations, limits)?,
        };
        if best.as_ref().is_some_and(|best| choice.best.score >= best.choice.best.score) {
            break;
        }
        if tension == 0.0 {
            of_plate = choice.best.lambda;
        }
        drop(equations);
        best = Some(Tense { tension, energy, choice });
    }
    best.ok_or_else(|| Error::usage("no tension to choose from"))
}

/// The energy `bending` with a tension, which is in units of one over the distance of observations.
///
/// # Errors
/// A tension that is negative or not finite; those of [`membrane`].
pub fn with_tension(
    basis: &Basis,
    normal: &NormalEquations,
    bending: Symmetric,
    tension: f64,
) -> Result<Symmetric> {
    check(tension)?;
    if tension == 0.0 {
        return Ok(bending);
    }
    Ok(tensed(&bending, &membrane(basis)?, tension, normal.area_per_observation(basis)))
}

fn equations<'a>(
    basis: &'a Basis,
    normal: &'a NormalEquations,
    energy: &'a Symmetric,
    tension: f64,
) -> Result<Equations<'a>> {
    let equations = Equations::new(basis, normal, Some(energy))?;
    Ok(if tension > 0.0 { equations.in_tension() } else { equations })
}

fn tensed(bending: &Symmetric, membrane: &Symmetric, tension: f64, area: f64) -> Symmetric {
    bending.plus(tension * tension / area, membrane)
}

fn check(tension: f64) -> Result<()> {
    if tension >= 0.0 && tension.is_finite() {
        return Ok(());
    }
    Err(Error::usage(format!("tension {tension}: expected a finite number, not negative")))
}

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
        Method::Generalised => generalised_cross_validation(equations, near),
        _ => restricted_likelihood(equations, near),
    }
}

//! Scores of smoothing parameters: generalised and k-fold cross-validation, and restricted maximum
//! likelihood.
//!
//! For the likelihood, the energy is a distribution of splines: coefficients are normally distributed with
//! the precision lambda E / s^2, and the errors of observations with W / s^2. Linear functions, which have no
//! energy, are integrated out. The likelihood of `lambda` is then that of all observations, whereas
//! cross-validation only counts errors at their places. A spline that follows all observations closely is
//! unlikely, even if it has small residuals. So this choice rarely smooths too little.
//!
//! Sources: Wahba 1985 (generalised maximum likelihood); Wood 2011 (restricted maximum likelihood).

use std::num::NonZeroUsize;
use std::sync::Arc;

use super::blocks::Observations;
use super::choice::{Choice, Limits, search};
use super::cholesky::Elimination;
use super::membrane::Correction;
use super::normal_equations::{NormalEquations, Parts};
use super::selected_inverse::trace_of_quotient;
use super::solve::Equations;
use super::symmetric::Symmetric;
use crate::bases::Basis;
use spmesh_base::error::{Error, Result};
use spmesh_base::random::Random;

/// Chooses by generalised cross-validation: the least (S / n) / (1 - t / n)^2, for n observations, the
/// weighted sum S of squared residuals, and the trace t of the smoothing matrix, which is exact. `near` is a
/// `lambda` that is nearly the best one, if one is known.
///
/// Cost: about six trials of a factorisation and a selected inverse each. Source: Craven and Wahba 1979.
///
/// # Errors
/// Those of [`Equations::solve`], if it fails for every `lambda`.
pub fn generalised_cross_validation(equations: &Equations, near: Option<f64>) -> Result<Choice> {
    search(Limits::of(equations).near(near), |lambda| Ok(Quality::of(equations, lambda)?.score))
}

/// Chooses as [`generalised_cross_validation`] does, but no lesser `lambda` than `least`, which is tried
/// first. `visit` gets all trials with their quality.
///
/// Cost: two trials if that one is the best.
///
/// # Errors
/// Those of [`Equations::solve`], if it fails for every `lambda`.
pub fn generalised_cross_validation_from(
    equations: &Equations,
    least: f64,
    mut visit: impl FnMut(f64, Quality),
) -> Result<Choice> {
    let limits = Limits { start: least, least, ..Limits::of(equations) };
    search(limits, |lambda| {
        let quality = Quality::of(equations, lambda)?;
        visit(lambda, quality);
        Ok(quality.score)
    })
}

/// How well a spline of some `lambda` predicts observations, as they tell themselves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quality {
    /// The effective number of parameters: the trace of the smoothing matrix.
    pub parameters: f64,
    /// The score of generalised cross-validation: about the mean square of errors of predictions, which is
    /// infinite if there are as many parameters as observations. Units: those of values, squared, times
    /// weights.
    pub score: f64,
    /// The standard deviation of an observation of weight one: of the residuals, corrected for the
    /// parameters.
    pub noise: f64,
}

impl Quality {
    /// The quality for a `lambda`.
    ///
    /// Cost: a factorisation and a selected inverse.
    ///
    /// # Errors
    /// Those of [`Equations::solve`].
    pub fn of(equations: &Equations, lambda: f64) -> Result<Quality> {
        equations.with_factor(lambda, |factor| {
            equations.check(factor, lambda)?;
            let normal = equations.normal();
            let parameters = trace_of_quotient(factor, &normal.matrix);
            let square = normal.residual_square(&equations.coefficients(factor, lambda));
            let (count, free) = (normal.count as f64, normal.count as f64 - parameters);
            if free <= 0.0 {
                return Ok(Quality { parameters, score: f64::INFINITY, noise: f64::NAN });
            }
            Ok(Quality { parameters, score: square * count / (free * free), noise: (square / free).sqrt() })
        })
    }
}

/// The effective number of parameters for a `lambda`: the trace of the smoothing matrix.
///
/// # Errors
/// Those of [`Equations::solve`].
pub fn degrees_of_freedom(equations: &Equations, lambda: f64) -> Result<f64> {
    Ok(Quality::of(equations, lambda)?.parameters)
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
        check(folds)?;
        let fold_of = |index: u64| fold_of(index, folds, seed);
        let parts = Parts::unweighed(basis, observations, threads, folds, fold_of)?;
        Folds::of_parts(&parts, folds)
    }

    /// The folds of equations in as many parts.
    pub(super) fn of_parts(parts: &Parts, folds: usize) -> Result<Folds> {
        check(folds)?;
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
    /// Cost: about six factorisations per fold. Accuracy of scores: about 1e-15 of the mean square of values.
    ///
    /// # Errors
    /// Those of [`Equations::solve`], if it fails for every `lambda`.
    pub fn choose(&self, basis: &Basis, energy: &Symmetric) -> Result<Choice> {
        self.choose_near(basis, energy, None, None)
    }

    /// [`Folds::choose`], for a `lambda` that is nearly the best one. The order of elimination is that of all
    /// observations, if it is known.
    pub(super) fn choose_near(
        &self,
        basis: &Basis,
        energy: &Symmetric,
        near: Option<f64>,
        mut elimination: Option<Arc<Elimination>>,
    ) -> Result<Choice> {
        let mut equations: Vec<Equations> = Vec::with_capacity(self.problems.len());
        for (kept, _) in &self.problems {
            let next = Equations::eliminated(basis, kept, Some(energy), elimination)?;
            elimination = Some(next.elimination());
            equations.push(next);
        }
        // In units of all observations: without one fold, weights and lambda are scaled down alike.
        let parts = self.problems.iter().map(|(kept, _)| kept.weight / self.weight);
        let limits = equations.iter().zip(parts).map(|(equations, part)| Limits::of(equations).over(part));
        let limits = limits.fold(Limits::NONE, Limits::both).near(near);
        search(limits, |lambda| {
            let mut sum = 0.0;
            for (equations, (kept, left_out)) in equations.iter().zip(&self.problems) {
                let part = kept.weight / self.weight;
                sum += left_out.residual_square(&equations.solve(lambda * part)?);
            }
            Ok(sum / self.weight)
        })
    }
}

/// The fold of an observation.
pub(super) fn fold_of(index: u64, folds: usize, seed: u64) -> usize {
    Random::new(seed ^ index.rotate_left(32)).below(folds as u64) as usize
}

fn check(folds: usize) -> Result<()> {
    if folds >= 2 {
        return Ok(());
    }
    Err(Error::usage(format!("{folds} folds: cross-validation needs two at least")))
}

/// Number of linear functions, which have no energy.
const LINEAR: f64 = 3.0;

/// Chooses the `lambda` of the greatest restricted likelihood. With the least value D of the weighted squared
/// residuals plus `lambda` times the energy, p functions, n observations and the matrix F of the equations,
/// the score is D / (n - 3) times |F lambda^-(p - 3)|^(1 / (n - 3)): except for a constant factor, minus the
/// logarithm of the likelihood is half of (n - 3) times the logarithm of the score.
///
/// `near` is as in [`generalised_cross_validation`]. Cost: about six factorisations.
///
/// # Errors
/// Those of [`Equations::solve`], if it fails for every `lambda`.
pub fn restricted_likelihood(equations: &Equations, near: Option<f64>) -> Result<Choice> {
    Likelihood::default().of_one(equations, Limits::of(equations).near(near))
}

/// Scores of several energies for the same observations and functions.
#[derive(Debug, Default)]
pub(super) struct Likelihood {
    /// The logarithm of the first determinant. It is the sum of large numbers: only its change counts.
    first: Option<f64>,
}

impl Likelihood {
    /// Chooses as [`restricted_likelihood`] does. Scores are divided by |E|^(1 / (n - 3)), where |E| is the
    /// determinant of the energy on splines without a linear part. So the scores of several energies can be
    /// compared.
    ///
    /// Cost: about seven factorisations.
    pub(super) fn choose(&mut self, equations: &Equations, limits: Limits) -> Result<Choice> {
        let of_energy = equations.log_determinant_of_energy()?;
        self.of_energy(equations, limits, of_energy)
    }

    /// Chooses as [`restricted_likelihood`] does. Its scores are those of one energy.
    pub(super) fn of_one(&mut self, equations: &Equations, limits: Limits) -> Result<Choice> {
        self.of_energy(equations, limits, 0.0)
    }

    fn of_energy(&mut self, equations: &Equations, limits: Limits, of_energy: f64) -> Result<Choice> {
        let normal = equations.normal();
        let free = normal.count as f64 - LINEAR;
        let bent = normal.matrix.len() as f64 - LINEAR;
        search(limits, |lambda| {
            equations.with_factor(lambda, |factor| {
                equations.check(factor, lambda)?;
                let correction = equations.correction(factor, lambda);
                let of_linear = correction.as_ref().map_or(0.0, Correction::log_determinant);
                let volume = factor.log_determinant() + of_linear - bent * lambda.ln() - of_energy;
                let change = volume - *self.first.get_or_insert(volume);
                let deviance = equations.deviance(factor, correction.as_ref());
                let score = deviance / free * (change / free).exp();
                Ok(if free > 0.0 { score } else { f64::INFINITY })
            })
        })
    }
}

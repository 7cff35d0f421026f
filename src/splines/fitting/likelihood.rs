//! The choice of the smoothing parameter by restricted maximum likelihood.
//!
//! The energy is read as a distribution of splines: the coefficients are normally distributed with the
//! precision lambda E / s^2, and the errors of observations with W / s^2. Linear functions, which have no
//! energy, are integrated out. The likelihood of `lambda` is then that of all observations, whereas
//! cross-validation only counts errors at their places. A spline that follows all observations closely is
//! unlikely, even if it has small residuals. So this choice rarely smooths too little.
//!
//! Sources: Wahba 1985 (generalised maximum likelihood); Wood 2011 (restricted maximum likelihood).

use super::choice::{Choice, Limits, search};
use super::linear_part::Correction;
use super::solve::Equations;
use spmesh_base::error::Result;

/// Number of linear functions, which have no energy.
const LINEAR: f64 = 3.0;

/// Chooses the `lambda` of the greatest restricted likelihood. With the least value D of the weighted squared
/// residuals plus `lambda` times the energy, p functions, n observations and the matrix F of the equations,
/// the score is D / (n - 3) times |F lambda^-(p - 3)|^(1 / (n - 3)): except for a constant factor, minus the
/// logarithm of the likelihood is half of (n - 3) times the logarithm of the score.
///
/// Cost: about six factorisations.
///
/// # Errors
/// Those of [`Equations::solve`], if it fails for every `lambda`.
pub fn restricted_likelihood(equations: &Equations) -> Result<Choice> {
    likelihood_near(equations, None)
}

/// [`restricted_likelihood`], for a `lambda` that is nearly the best one.
pub(super) fn likelihood_near(equations: &Equations, near: Option<f64>) -> Result<Choice> {
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

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
use super::solve::Equations;
use spmesh_core::error::Result;

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
    let normal = equations.normal();
    let free = normal.count as f64 - LINEAR;
    let bent = normal.matrix.len() as f64 - LINEAR;
    // The logarithm of the determinant is the sum of large numbers: only its change counts.
    let mut first = None;
    search(Limits::of(equations).near(near), |lambda| {
        equations.with_factor(lambda, |factor| {
            equations.check(factor, lambda)?;
            let volume = factor.log_determinant() - bent * lambda.ln();
            let change = volume - *first.get_or_insert(volume);
            let score = equations.deviance(factor) / free * (change / free).exp();
            Ok(if free > 0.0 { score } else { f64::INFINITY })
        })
    })
}

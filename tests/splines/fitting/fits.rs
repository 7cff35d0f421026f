//! Whole fits in one call.

use std::num::NonZeroUsize;

use spmesh_base::error::Result;
use spmesh_splines::bases::Basis;
use spmesh_splines::fitting::{
    self, Equations, Loss, NormalEquations, Observations, Residual, RobustFit, Symmetric, bending,
    for_each_residual,
};

/// Coefficients of the least-squares spline, smoothed by `lambda`.
pub(crate) fn least_squares<O: Observations + ?Sized>(
    basis: &Basis,
    observations: &O,
    lambda: f64,
    threads: NonZeroUsize,
) -> Result<Vec<f64>> {
    let normal = NormalEquations::of(basis, observations, threads)?;
    let energy = if lambda > 0.0 { Some(bending(basis)?) } else { None };
    Equations::new(basis, &normal, energy.as_ref())?.solve(lambda)
}

/// A robust fit from nothing but the observations.
pub(crate) fn robust<O: Observations + ?Sized>(
    basis: &Basis,
    observations: &O,
    loss: Loss,
    energy: Option<&Symmetric>,
    lambda: f64,
    threads: NonZeroUsize,
) -> Result<RobustFit> {
    let plain = NormalEquations::of(basis, observations, threads)?;
    fitting::robust(&plain, basis, observations, loss, energy, lambda, threads)
}

/// The residuals of all observations in the domain.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Summary {
    pub(crate) count: u64,
    pub(crate) outside: u64,
    /// The first of greatest magnitude.
    pub(crate) worst: Option<Residual>,
    pub(crate) root_mean_square: f64,
    pub(crate) mean: f64,
}

pub(crate) fn summarise<O: Observations + ?Sized>(
    basis: &Basis,
    coefficients: &[f64],
    observations: &O,
    threads: NonZeroUsize,
) -> Result<Summary> {
    let (mut summary, mut sum, mut square) = (Summary::default(), 0.0, 0.0);
    summary.outside = for_each_residual(basis, coefficients, observations, threads, |found| {
        summary.count += 1;
        sum += found.residual;
        square += found.residual * found.residual;
        if summary.worst.is_none_or(|worst| found.residual.abs() > worst.residual.abs()) {
            summary.worst = Some(found);
        }
    })?;
    let count = summary.count.max(1) as f64;
    summary.mean = sum / count;
    summary.root_mean_square = (square / count).sqrt();
    Ok(summary)
}

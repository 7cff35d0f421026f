//! Residuals of observations.

use super::blocks::{self, Block};
use super::observations::{Observation, Observations};
use crate::bases::{Basis, Scratch};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::Point2;
use std::num::NonZeroUsize;

/// A residual: the value of an observation minus the value of the spline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// The number of the observation.
    pub index: u64,
    /// Its place.
    pub point: Point2,
    /// The value of the observation.
    pub value: f64,
    /// Value minus spline.
    pub residual: f64,
    /// Weight of the observation.
    pub weight: f64,
}

/// Summary of the residuals of all observations in the domain.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Summary {
    /// Number of observations in the domain.
    pub count: u64,
    /// Number of observations outside of the domain.
    pub outside: u64,
    /// The residual of greatest magnitude; the first one if there are several.
    pub worst: Option<Residual>,
    /// Root of the mean square, not weighted.
    pub root_mean_square: f64,
    /// Mean.
    pub mean: f64,
}

/// The value of a spline, given the functions alive.
#[inline]
pub(super) fn value(coefficients: &[f64], alive: &[(u32, f64)]) -> f64 {
    alive.iter().map(|&(function, value)| coefficients[function as usize] * value).sum()
}

/// Calls `visit` with all residuals in the domain, in order; returns the number of observations outside.
///
/// # Errors
/// Those of the source; a number of coefficients other than the number of functions.
pub fn for_each_residual<O: Observations + ?Sized>(
    basis: &Basis,
    coefficients: &[f64],
    observations: &O,
    threads: NonZeroUsize,
    mut visit: impl FnMut(Residual),
) -> Result<u64> {
    check_count(basis, coefficients)?;
    let map = |block: Block| {
        let mut scratch = Scratch::default();
        let inside = block.numbered().filter(|(_, observation)| basis.is_in_domain(observation.point));
        let all: Vec<Residual> = inside
            .map(|(index, observation)| {
                let alive = basis.at(observation.point, &mut scratch);
                let residual = observation.value - self::value(coefficients, alive);
                let Observation { point, value, weight } = *observation;
                Residual { index, point, value, residual, weight }
            })
            .collect();
        Ok((block.observations.len() - all.len(), all))
    };
    let mut outside = 0;
    blocks::for_each_round(observations, threads, map, |round| {
        for (out, residuals) in round {
            outside += out as u64;
            residuals.into_iter().for_each(&mut visit);
        }
        Ok(())
    })?;
    Ok(outside)
}

/// Summarises residuals in one pass.
///
/// # Errors
/// Those of [`for_each_residual`].
pub fn summarise<O: Observations + ?Sized>(
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

pub(super) fn check_count(basis: &Basis, coefficients: &[f64]) -> Result<()> {
    if coefficients.len() == basis.len() {
        return Ok(());
    }
    let (found, needed) = (coefficients.len(), basis.len());
    Err(Error::usage(format!("{found} coefficients for {needed} functions: one each is needed")))
}

//! Residuals of observations, and quantiles of their magnitudes from one pass in a fixed amount of memory.

use std::num::NonZeroUsize;

use super::blocks::{self, Block, Observation, Observations};
use crate::bases::{Basis, Scratch};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::Point2;

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

pub(super) fn check_count(basis: &Basis, coefficients: &[f64]) -> Result<()> {
    if coefficients.len() == basis.len() {
        return Ok(());
    }
    let (found, needed) = (coefficients.len(), basis.len());
    Err(Error::usage(format!("{found} coefficients for {needed} functions: one each is needed")))
}

/// Number of bits, below the sign, that determine the class of a number: 11 of the exponent, 7 of the
/// fraction.
const CLASS_BITS: u32 = 18;
/// Bits below the class bits.
const SHIFT: u32 = 63 - CLASS_BITS;

/// Counts of magnitudes in classes of equal relative width. Memory: 2 MB.
#[derive(Debug, Clone)]
pub struct QuantileSketch {
    counts: Vec<u64>,
    total: u64,
}

impl Default for QuantileSketch {
    fn default() -> QuantileSketch {
        QuantileSketch { counts: vec![0; 1 << CLASS_BITS], total: 0 }
    }
}

impl QuantileSketch {
    /// Counts a finite number by its magnitude.
    pub fn add(&mut self, number: f64) {
        self.counts[(number.abs().to_bits() >> SHIFT) as usize] += 1;
        self.total += 1;
    }

    /// The lower median of magnitudes. Accuracy: as [`QuantileSketch::quantile`].
    pub fn median(&self) -> Option<f64> {
        self.quantile(0.5)
    }

    /// The least magnitude q such that `part` of all magnitudes are at most q. It is rounded to the middle of
    /// its class, at most half a percent off. `None` without numbers.
    ///
    /// Domain: 0 < `part` <= 1.
    pub fn quantile(&self, part: f64) -> Option<f64> {
        let enough = (part * self.total as f64).ceil() as u64;
        let mut below = 0;
        let is_reached = |count: &u64| {
            below += count;
            below >= enough
        };
        let class = self.counts.iter().position(is_reached).filter(|_| self.total > 0)? as u64;
        // In practice zero is the only number of its class, and for exact data it is the only residual.
        let middle = if class == 0 { 0 } else { 1 << (SHIFT - 1) };
        Some(f64::from_bits((class << SHIFT) + middle))
    }
}

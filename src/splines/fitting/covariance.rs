//! How sure a fit is: the covariance of its coefficients.
//!
//! With F = A'WA + lambda E and observations whose errors have the variance s^2 over their weight, the
//! covariance of coefficients is s^2 F^-1, if lambda E / s^2 is the precision of what was known before
//! (Wahba 1983; Nychka 1988: its intervals hold as often as they say, on average over observations). The
//! variance of the value b'c at a place needs the entries of F^-1 for functions that overlap, which are those
//! of the selected inverse.

use super::membrane::{Correction, OfLinear, without_linear};
use super::selected_inverse::selected;
use super::solve::Equations;
use super::symmetric::Symmetric;
use crate::bases::Basis;
use spmesh_base::error::{Error, Result};

/// The covariance of coefficients, for observations of weight one with variance one.
#[derive(Debug)]
pub struct Covariance {
    /// The entries of F^-1 for functions that overlap.
    entries: Symmetric,
    /// For an energy without its linear part.
    linear: Option<OfLinear>,
}

impl Covariance {
    /// The covariance for a `lambda`.
    ///
    /// Cost: a factorisation and a selected inverse. Memory: that of two factors.
    ///
    /// # Errors
    /// Those of [`Equations::solve`].
    pub fn of(equations: &Equations, lambda: f64) -> Result<Covariance> {
        equations.with_factor(lambda, |factor| {
            equations.check(factor, lambda)?;
            let correction = equations.correction(factor, lambda);
            Ok(Covariance {
                entries: selected(factor, &equations.matrix(lambda)),
                linear: correction.as_ref().map(Correction::of_inverse),
            })
        })
    }

    /// The variance of the sum of functions with these values, given by number and value.
    pub fn variance(&self, values: &[(u32, f64)]) -> f64 {
        let mut sum = 0.0;
        for (at, &(first, a)) in values.iter().enumerate() {
            sum += a * a * self.entries.at(first as usize, first as usize);
            for &(second, b) in &values[at + 1..] {
                sum += 2.0 * a * b * self.entries.at(first as usize, second as usize);
            }
        }
        if let Some(OfLinear { columns, rest }) = &self.linear {
            let of = |column: &Vec<f64>| values.iter().map(|&(at, value)| column[at as usize] * value).sum();
            let [p, q]: [f64; 2] = columns.each_ref().map(of);
            sum += p * (rest[0][0] * p + rest[0][1] * q) + q * (rest[1][0] * p + rest[1][1] * q);
        }
        sum.max(0.0)
    }
}

/// The equations that coefficients solve, as far as they tell it themselves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recovered {
    /// The factor of the thin-plate energy.
    pub lambda: f64,
    /// The factor of the membrane energy.
    pub of_membrane: f64,
}

/// Equations of which coefficients are within this part of the forces that act on them.
const ACCURACY: f64 = 1e-6;

/// The smoothing that a spline was fitted with: the factors of both energies for which its coefficients
/// balance what observations ask for.
///
/// # Errors
/// Usage, if there are no such factors: the spline is not a plain fit to these observations.
pub fn recovered(
    basis: &Basis,
    equations: &Equations,
    [bending, membrane]: [&Symmetric; 2],
    coefficients: &[f64],
) -> Result<Recovered> {
    let forces = equations.forces(coefficients);
    let p = bending.times(coefficients);
    let q = membrane.times(&without_linear(basis, membrane, coefficients));
    let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let left_over = |[x, y]: [f64; 2]| {
        let square =
            forces.iter().zip(p.iter().zip(&q)).map(|(force, (p, q))| (force - x * p - y * q).powi(2));
        square.sum::<f64>().sqrt()
    };
    let alone = sum(&forces, &p) / sum(&p, &p);
    let determinant = sum(&p, &p) * sum(&q, &q) - sum(&p, &q).powi(2);
    let both = [
        (sum(&forces, &p) * sum(&q, &q) - sum(&forces, &q) * sum(&p, &q)) / determinant,
        (sum(&forces, &q) * sum(&p, &p) - sum(&forces, &p) * sum(&p, &q)) / determinant,
    ];
    let enough = ACCURACY * sum(&forces, &forces).sqrt();
    for [lambda, of_membrane] in [[alone, 0.0], both] {
        if lambda > 0.0 && of_membrane >= 0.0 && left_over([lambda, of_membrane]) <= enough {
            return Ok(Recovered { lambda, of_membrane });
        }
    }
    Err(Error::usage(
        "the spline is not a fit to these points with their weights and one smoothing: give the points that it \
         was fitted to; robust and interpolating splines have no standard errors",
    ))
}

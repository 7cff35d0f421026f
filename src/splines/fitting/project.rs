//! A spline over other knots: the restriction to a smaller domain.

use std::num::NonZeroUsize;

use super::blocks::Observation;
use super::energy::bending;
use super::normal_equations::NormalEquations;
use super::solve::Equations;
use crate::bases::{Basis, Scratch};
use spmesh_base::error::Result;
use spmesh_delaunay::predicates::Point2;

/// The smoothing, in units of the default: functions that have no site of their own are as smooth as
/// possible.
const SMOOTHING: f64 = 1e-6;

/// The coefficients over the basis `to` of a spline over the basis `from`: least squares of its values at the
/// Greville sites, and at other sites, as far as they are in both domains. Where both have the same knots
/// around, they are the same functions, and nothing changes but by rounding and the smoothing.
///
/// # Errors
/// Those of [`Equations::solve`].
pub fn projected(
    from: (&Basis, &[f64]),
    to: &Basis,
    sites: impl Iterator<Item = Point2>,
    threads: NonZeroUsize,
) -> Result<Vec<f64>> {
    let (basis, coefficients) = from;
    let mut scratch = Scratch::default();
    let own = (0..to.len()).map(|function| to.greville(function));
    let sites = own.chain(sites).filter(|&site| basis.is_in_domain(site) && to.is_in_domain(site));
    let observations: Vec<Observation> =
        sites.map(|site| Observation::new(site, basis.value(coefficients, site, &mut scratch))).collect();
    let normal = NormalEquations::of(to, &observations, threads)?;
    let energy = bending(to)?;
    let lambda = SMOOTHING * normal.default_lambda(to);
    Equations::new(to, &normal, Some(&energy))?.solve(lambda)
}

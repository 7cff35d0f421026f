//! Coefficients from normal equations, with or without smoothing.

use super::cholesky::{Elimination, Factor};
use super::energy::check_domain;
use super::least_energy;
use super::membrane::{Correction, LinearPart, corners};
use super::normal_equations::NormalEquations;
use super::symmetric::Symmetric;
use super::trend::{Trend, trend};
use crate::bases::Basis;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::Point2;
use std::sync::Arc;

/// Coefficients that solve equations.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// One for each function.
    pub coefficients: Vec<f64>,
    /// Whether they solve the equations except for rounding. The steps that lead to the least energy may not
    /// get there; all other solutions do.
    pub has_converged: bool,
}

/// A function that observations do not determine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Undetermined {
    /// Its number.
    pub function: usize,
    /// Its Greville site.
    pub site: Point2,
    /// The change of the equations along the undetermined direction, relative to what observations add to
    /// their diagonal: about 1e-13, or zero without any observation.
    pub curvature: f64,
}

/// A penalised least squares problem: (A'WA + lambda E) c = A'Wz for all `lambda`.
///
/// E is the thin-plate energy or another energy. If weights are reciprocal variances and `lambda` is one,
/// c'Ec acts as prior knowledge. A greater `lambda` makes smoother splines; the limit is the least-squares
/// plane.
#[derive(Debug)]
pub struct Equations<'a> {
    basis: &'a Basis,
    normal: &'a NormalEquations,
    energy: Option<&'a Symmetric>,
    elimination: Arc<Elimination>,
    /// The linear function that is nearest to the observations.
    trend: Trend,
    /// The right side of the equations for the difference from the trend.
    right: Vec<f64>,
    /// The part of the energy that does not count, because linear functions have it.
    linear: Option<LinearPart>,
}

impl<'a> Equations<'a> {
    /// The equations of a basis. For a `lambda` of zero, `energy` may be `None`.
    ///
    /// # Errors
    /// No observation in the domain; matrices of another basis; not enough memory.
    pub fn new(
        basis: &'a Basis,
        normal: &'a NormalEquations,
        energy: Option<&'a Symmetric>,
    ) -> Result<Equations<'a>> {
        Equations::eliminated(basis, normal, energy, None)
    }

    /// Like [`Equations::new`], with the order of elimination of other equations of the same pattern: those
    /// of the same observations with other weights.
    pub(super) fn eliminated(
        basis: &'a Basis,
        normal: &'a NormalEquations,
        energy: Option<&'a Symmetric>,
        elimination: Option<Arc<Elimination>>,
    ) -> Result<Equations<'a>> {
        let found = normal.matrix.len();
        if found != basis.len() || energy.is_some_and(|energy| energy.len() != found) {
            return Err(Error::usage(format!(
                "matrices of other functions: {found} rows for {} functions",
                basis.len()
            )));
        }
        if normal.count == 0 {
            check_domain(basis)?;
        }
        normal.check()?;
        let elimination = match (elimination, energy) {
            (Some(known), _) => known,
            (None, Some(energy)) => Arc::new(Elimination::of(&normal.matrix.plus(0.0, energy))?),
            (None, None) => Arc::new(Elimination::of(&normal.matrix)?),
        };
        let trend = trend(basis, normal);
        let done = normal.matrix.times(&trend.coefficients);
        let right = normal.right.iter().zip(done).map(|(right, done)| right - done).collect();
        Ok(Equations { basis, normal, energy, elimination, trend, right, linear: None })
    }

    /// The equations with the energy that splines have after the best linear function is subtracted. Only
    /// constants may have no energy, as with [`with_tension`](super::with_tension).
    pub fn in_tension(self) -> Equations<'a> {
        Equations { linear: self.energy.map(|energy| LinearPart::of(self.basis, energy)), ..self }
    }

    /// The order of elimination, for equations of the same pattern.
    pub(super) fn elimination(&self) -> Arc<Elimination> {
        Arc::clone(&self.elimination)
    }

    /// The normal equations.
    pub fn normal(&self) -> &NormalEquations {
        self.normal
    }

    /// The default `lambda`: see [`NormalEquations::default_lambda`].
    pub fn default_lambda(&self) -> f64 {
        self.normal.default_lambda(self.basis)
    }

    /// The coefficients for a `lambda`, whether they have converged or not: see [`Equations::solution`].
    ///
    /// # Errors
    /// Those of [`Equations::solution`].
    pub fn solve(&self, lambda: f64) -> Result<Vec<f64>> {
        Ok(self.solution(lambda)?.coefficients)
    }

    /// The solution for a `lambda`. If it is zero and there is an energy, it is that of least squares; if
    /// observations do not determine all functions, the one with the least energy.
    ///
    /// # Errors
    /// Functions that are not determined, with their number and the place of the first one; a `lambda` that
    /// is negative or not finite, or above zero without an energy.
    pub fn solution(&self, lambda: f64) -> Result<Solution> {
        // Least energy: so much of it as makes equations regular.
        let is_least = lambda == 0.0 && self.energy.is_some();
        let factored = if is_least { least_energy::SHARE * self.unit() } else { lambda };
        self.with_factor(factored, |factor| {
            self.check(factor, lambda)?;
            let found = match is_least {
                true => self.of_least_energy(factor),
                false => Solution { coefficients: self.coefficients(factor, lambda), has_converged: true },
            };
            if found.coefficients.iter().all(|c| c.is_finite()) {
                return Ok(found);
            }
            Err(Error::malformed("coefficients are too great for 64 bits: scale the values"))
        })
    }

    /// All functions that are not determined, in order. Of several functions that depend on each other, all
    /// but one are listed.
    ///
    /// # Errors
    /// A `lambda` as in [`Equations::solve`].
    pub fn undetermined(&self, lambda: f64) -> Result<Vec<Undetermined>> {
        self.with_factor(lambda, |factor| Ok(self.named(factor)))
    }

    /// The `lambda` for which observations and energy count alike: the median ratio of their diagonals. It
    /// serves as the unit of `lambda`, and is zero without an energy. (The ratio of traces would depend on
    /// the few functions with knots near lines, which are stiff.)
    pub fn unit(&self) -> f64 {
        let Some(energy) = self.energy else { return 0.0 };
        let both = self.normal.matrix.diagonal().zip(energy.diagonal());
        let mut ratios: Vec<f64> = both.filter(|&(n, e)| n > 0.0 && e > 0.0).map(|(n, e)| n / e).collect();
        if ratios.is_empty() {
            return 0.0;
        }
        let middle = ratios.len() / 2;
        *ratios.select_nth_unstable_by(middle, f64::total_cmp).1
    }

    /// Calls `work` with the factored equations for a `lambda`.
    pub(super) fn with_factor<T>(&self, lambda: f64, work: impl FnOnce(&Factor) -> Result<T>) -> Result<T> {
        if !(lambda >= 0.0 && lambda.is_finite()) {
            return Err(Error::usage(format!("lambda {lambda}: expected a finite number, not negative")));
        }
        match self.energy {
            Some(energy) => {
                let matrix = self.normal.matrix.plus(lambda, energy);
                work(&self.elimination.factor(&matrix)?)
            }
            None if lambda > 0.0 => Err(Error::usage("there is no energy that lambda could be a factor of")),
            None => work(&self.elimination.factor(&self.normal.matrix)?),
        }
    }

    /// The matrix of the equations for a `lambda`, without what the linear part of the energy changes.
    pub(super) fn matrix(&self, lambda: f64) -> Symmetric {
        let energy = self.energy.filter(|_| lambda > 0.0);
        energy.map_or_else(|| self.normal.matrix.clone(), |energy| self.normal.matrix.plus(lambda, energy))
    }

    /// What observations add to the equations of some coefficients: the gradient of half the sum of squares,
    /// downwards.
    pub(super) fn forces(&self, coefficients: &[f64]) -> Vec<f64> {
        let rest: Vec<f64> =
            coefficients.iter().zip(&self.trend.coefficients).map(|(c, trend)| c - trend).collect();
        self.right.iter().zip(self.normal.matrix.times(&rest)).map(|(right, done)| right - done).collect()
    }

    /// What the linear part of the energy changes, if it has one.
    pub(super) fn correction(&self, factor: &Factor, lambda: f64) -> Option<Correction<'_>> {
        self.linear.as_ref().map(|part| part.correction(factor, lambda))
    }

    /// The least value of the weighted squared residuals plus `lambda` times the energy. Accuracy: about
    /// 1e-15 of z'Wz.
    pub(super) fn deviance(&self, factor: &Factor, correction: Option<&Correction>) -> f64 {
        let rest = self.rest(factor, correction);
        let explained: f64 = rest.iter().zip(&self.right).map(|(c, right)| c * right).sum();
        (self.normal.residual_square(&self.trend.coefficients) - explained).max(0.0)
    }

    /// The coefficients from the equations that are factored for `lambda`.
    pub(super) fn coefficients(&self, factor: &Factor, lambda: f64) -> Vec<f64> {
        self.with_trend(self.rest(factor, self.correction(factor, lambda).as_ref()))
    }

    /// The coefficients of the difference from the trend.
    fn rest(&self, factor: &Factor, correction: Option<&Correction>) -> Vec<f64> {
        let mut rest = factor.solve(&self.right);
        if let Some(correction) = correction {
            correction.apply(&mut rest);
        }
        rest
    }

    /// The logarithm of the determinant of the energy on splines without a linear part, except for a constant
    /// that depends only on the basis. With an energy of linear functions, that of S is left out (see
    /// [`LinearPart`]).
    ///
    /// Some coefficients are held by springs, as many as there are functions without energy: the determinant
    /// is then that of the springs, times that of the energy for fixed ends, which is a known multiple.
    pub(super) fn log_determinant_of_energy(&self) -> Result<f64> {
        let energy = self.energy.ok_or_else(|| Error::usage("there is no energy"))?;
        let (held, volume) = if self.linear.is_some() { (vec![0], 0.0) } else { corners(self.basis) };
        let mut matrix = energy.plus(0.0, &self.normal.matrix);
        let springs: Vec<f64> = held.iter().map(|&function| energy.at(function, function)).collect();
        held.iter().zip(&springs).for_each(|(&function, &spring)| matrix.add_to_diagonal(function, spring));
        let of_springs: f64 = springs.iter().map(|spring| spring.ln()).sum();
        Ok(self.elimination.factor(&matrix)?.log_determinant() - of_springs - 2.0 * volume)
    }

    fn of_least_energy(&self, factor: &Factor) -> Solution {
        let size = self.normal.square.sqrt();
        let rest = least_energy::solve(&self.normal.matrix, factor, &self.right, size);
        Solution { coefficients: self.with_trend(rest.coefficients), ..rest }
    }

    fn with_trend(&self, rest: Vec<f64>) -> Vec<f64> {
        self.trend.coefficients.iter().zip(rest).map(|(trend, rest)| trend + rest).collect()
    }

    /// Refuses factored equations that leave functions undetermined.
    pub(super) fn check(&self, factor: &Factor, lambda: f64) -> Result<()> {
        self.check_trend()?;
        self.refuse(&self.named(factor), lambda)
    }

    fn named(&self, factor: &Factor) -> Vec<Undetermined> {
        let named = |(function, curvature)| {
            let site = self.basis.greville(function);
            Undetermined { function, site, curvature }
        };
        factor.weak(&self.sizes()).into_iter().map(named).collect()
    }

    /// What observations add to the diagonal; for functions without any, the mean of the others.
    fn sizes(&self) -> Vec<f64> {
        let observed = || self.normal.matrix.diagonal().filter(|&own| own > 0.0);
        let mean = observed().sum::<f64>() / observed().count().max(1) as f64;
        self.normal.matrix.diagonal().map(|own| if own > 0.0 { own } else { mean }).collect()
    }

    /// Refuses observations that determine no linear function, however smooth the spline is.
    fn check_trend(&self) -> Result<()> {
        if self.energy.is_none() || self.trend.is_determined {
            return Ok(());
        }
        Err(Error::usage(format!(
            "the {} observations in the domain are on one line, or nearly all of their weight is, so no \
             slope across it is determined: give some off the line",
            self.normal.count
        )))
    }

    fn refuse(&self, undetermined: &[Undetermined], lambda: f64) -> Result<()> {
        let Some(first) = undetermined.first() else { return Ok(()) };
        let empty = undetermined.iter().filter(|weak| self.is_empty_at(weak.function)).count();
        let narrow = self.basis.narrow();
        let narrow = undetermined.iter().filter(|weak| narrow.binary_search(&weak.function).is_ok()).count();
        let remedy = if narrow > 0 {
            "knots that are on one line except for rounding leave narrow functions between them: smooth with \
             a lambda above zero, or move these knots off the line"
        } else if self.energy.is_some() && lambda > self.unit() {
            "the lambda of this fit leaves observations no weight, a lesser one (--lambda) leaves them some"
        } else if self.energy.is_some() {
            "smooth with a greater lambda, or give more observations"
        } else {
            "smooth with a lambda above zero, or use fewer knots there"
        };
        Err(Error::usage(format!(
            "{} of {} functions are not determined by {} observations: {empty} of these functions have \
             none, and the others too few; the first one is at {} {}: {remedy}",
            undetermined.len(),
            self.basis.len(),
            self.normal.count,
            first.site[0],
            first.site[1],
        )))
    }

    fn is_empty_at(&self, function: usize) -> bool {
        self.normal.matrix.at(function, function) == 0.0
    }
}

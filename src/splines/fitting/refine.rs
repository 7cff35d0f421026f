//! The search for knots: fits that add knots until residuals are small enough.
//!
//! The first knots are a coarse grid over the box of the data. Each round fits a spline, and finds the
//! greatest residual in each triangle of knots (`triangle_residuals`). Where it exceeds the tolerance, a new
//! knot is placed about halfway between the residual and the middle of the triangle: close to the residual,
//! and away from knots and edges. Next to the border, the new knot is the middle of the border edge instead
//! (`knot_placement`).

use std::num::NonZeroUsize;

use super::blocks::Observations;
use super::energy::bending;
use super::knot_placement::{KNOTS_MIN, bounds, break_border_chords, first_grid};
use super::mesh::SplineSpace;
use super::normal_equations::NormalEquations;
use super::robust::{Loss, ROUNDS_FEW, Rounds};
use super::solve::Equations;
use super::triangle_residuals::TriangleResiduals;
use spmesh_base::error::{Error, Result};

/// A spline and the knots that were found for it.
#[derive(Debug)]
pub struct Refined {
    /// Knots and functions.
    pub space: SplineSpace,
    /// Coefficients.
    pub coefficients: Vec<f64>,
    /// All rounds; the last one describes the result.
    pub rounds: Vec<Round>,
    /// Whether all residuals are within the tolerance, except those of rejected observations. If not, the
    /// search reached the maximum of knots, or there were too few observations to add more.
    pub is_reached: bool,
}

/// Fits a spline, and adds knots until a goal is reached.
///
/// Cost: about ten rounds of two passes over the observations each; with a loss, ten times as many passes.
///
/// # Errors
/// Goals out of range; observations that span no area; those of [`NormalEquations::of`] and
/// [`Equations::solve`].
pub fn refine<O: Observations + ?Sized>(
    observations: &O,
    goal: &Goal,
    threads: NonZeroUsize,
) -> Result<Refined> {
    goal.check()?;
    let first = first_grid(bounds(observations)?);
    let middles = break_border_chords(&first, Vec::new(), goal.max_knots - first.len())?;
    let mut places = [first, middles].concat();
    let mut rounds = Vec::new();
    loop {
        let space = SplineSpace::of(places)?;
        let Solution { coefficients, limit } = Solution::of(&space, observations, goal, threads)?;
        let by_triangle = TriangleResiduals::of(&space, &coefficients, limit, observations, goal, threads)?;
        rounds.push(by_triangle.round);
        let is_reached = by_triangle.round.above == 0;
        let wanted = if is_reached { Vec::new() } else { by_triangle.knots(&space.mesh, goal) };
        let added_max = goal.max_knots.saturating_sub(space.mesh.points().len());
        let added = break_border_chords(space.mesh.points(), wanted, added_max)?;
        if added.is_empty() {
            return Ok(Refined { space, coefficients, rounds, is_reached });
        }
        places = space.mesh.points().to_vec();
        places.extend(added);
    }
}

/// The fit over the knots of one round.
struct Solution {
    coefficients: Vec<f64>,
    /// Observations whose residual, times the root of the weight, is greater are rejected.
    limit: f64,
}

impl Solution {
    fn of<O: Observations + ?Sized>(
        space: &SplineSpace,
        observations: &O,
        goal: &Goal,
        threads: NonZeroUsize,
    ) -> Result<Solution> {
        let normal = NormalEquations::of(&space.basis, observations, threads)?;
        let energy = bending(&space.basis)?;
        let (basis, energy) = (&space.basis, Some(&energy));
        let lambda = goal.smoothing * normal.default_lambda(basis);
        let Some(loss) = goal.loss else {
            let coefficients = Equations::new(basis, &normal, energy)?.solve(lambda)?;
            return Ok(Solution { coefficients, limit: f64::INFINITY });
        };
        let rounds = Rounds { basis, observations, energy, lambda, threads, most: ROUNDS_FEW };
        let fit = rounds.fit(loss, &normal)?;
        Ok(Solution { limit: fit.limit(), coefficients: fit.coefficients })
    }
}

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Greatest magnitude of residuals that is good enough. Units: those of values.
    pub tolerance: f64,
    /// Greatest number of places of knots; copies on the border do not count.
    pub max_knots: usize,
    /// The factor of the energy, in units of [`default_lambda`](super::NormalEquations::default_lambda). It
    /// must not be zero, so that the energy bridges gaps in the data.
    pub smoothing: f64,
    /// The loss function of a robust fit; `None` for least squares.
    pub loss: Option<Loss>,
}

impl Goal {
    /// A goal with the default smoothing, least squares, and these limits.
    pub fn new(tolerance: f64, max_knots: usize) -> Goal {
        Goal { tolerance, max_knots, smoothing: 1.0, loss: None }
    }

    /// Refuses goals out of range.
    ///
    /// # Errors
    /// A tolerance, a number of knots or a smoothing that is too small.
    pub fn check(&self) -> Result<()> {
        if self.tolerance.is_nan() || self.tolerance <= 0.0 {
            return Err(Error::usage(format!("tolerance {}: expected a number above zero", self.tolerance)));
        }
        if self.max_knots < KNOTS_MIN {
            return Err(Error::usage(format!("{} knots: {KNOTS_MIN} are needed at least", self.max_knots)));
        }
        if !(self.smoothing > 0.0 && self.smoothing.is_finite()) {
            let what = format!("smoothing {}: expected a finite number above zero", self.smoothing);
            return Err(Error::usage(what));
        }
        Ok(())
    }
}

/// One round in numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Round {
    /// Places of knots.
    pub knots: usize,
    /// Functions.
    pub functions: usize,
    /// Greatest magnitude of residuals.
    pub greatest: f64,
    /// Root of the mean square of residuals.
    pub root_mean_square: f64,
    /// Number of residuals above the tolerance, without those of rejected observations.
    pub above: u64,
}

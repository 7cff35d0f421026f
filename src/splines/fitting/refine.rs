//! Knots where they are needed: fits that add knots until residuals are small enough.
//!
//! The knots begin as a coarse grid over the box of the data. Each round fits a spline, and looks for the greatest residual in
//! each triangle of knots (`triangle_residuals`). Where it is above the tolerance, a new knot about halfway between the place and the middle
//! of the triangle: near to where it is needed, and away from knots and edges. Next to the border it is the middle of the border's
//! edge instead (`knot_placement`).

use super::control_energy::bending;
use super::knot_placement::{KNOTS_MIN, bounds, first_places, settled};
use super::normal_equations::Normal;
use super::observations::Observations;
use super::robust::{Loss, ROUNDS_FEW, Rounds};
use super::solve::Equations;
use super::spline_space::Cover;
use super::triangle_residuals::Survey;
use spmesh_core::error::{Error, Result};
use std::num::NonZeroUsize;

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Greatest magnitude of residuals that is good enough. Units: those of values.
    pub tolerance: f64,
    /// Most places of knots: copies on the border do not count.
    pub max_knots: usize,
    /// The factor of the energy, in units of [`Normal::halving`]: not zero, so that gaps in the data are bridged.
    pub smoothing: f64,
    /// What residuals cost, if not their squares.
    pub loss: Option<Loss>,
}

impl Goal {
    /// A goal with as much smoothing as observations can bear.
    #[must_use]
    pub fn new(tolerance: f64, max_knots: usize) -> Goal {
        Goal { tolerance, max_knots, smoothing: 1.0, loss: None }
    }

    fn check(&self) -> Result<()> {
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
    /// Number of residuals above the tolerance, but for rejected observations.
    pub above: u64,
}

/// A spline with knots of its own.
#[derive(Debug)]
pub struct Refined {
    /// Knots and functions.
    pub cover: Cover,
    /// Coefficients.
    pub coefficients: Vec<f64>,
    /// All rounds; the last one is that of the result.
    pub rounds: Vec<Round>,
    /// Whether all residuals are within the tolerance, but for rejected observations. If not, knots were used up, or there were too
    /// few observations to add more.
    pub is_reached: bool,
}

/// Fits a spline with as many knots as a goal takes.
///
/// Errors: goals that make no sense; observations in no area; those of [`Normal::of`] and [`Equations::solve`].
///
/// Cost: two passes over the observations for each round, of which there are about ten; with a loss, ten times as many.
pub fn refine<O: Observations + ?Sized>(
    observations: &O,
    goal: &Goal,
    threads: NonZeroUsize,
) -> Result<Refined> {
    goal.check()?;
    let first = first_places(bounds(observations)?);
    let middles = settled(&first, Vec::new(), goal.max_knots - first.len())?;
    let mut places = [first, middles].concat();
    let mut rounds = Vec::new();
    loop {
        let cover = Cover::of(places)?;
        let Solution { coefficients, limit } = Solution::of(&cover, observations, goal, threads)?;
        let survey = Survey::of(&cover, &coefficients, limit, observations, goal, threads)?;
        rounds.push(survey.round);
        let is_reached = survey.round.above == 0;
        let wanted = if is_reached { Vec::new() } else { survey.knots(&cover.mesh, goal) };
        let room = goal.max_knots.saturating_sub(cover.mesh.points().len());
        let added = settled(cover.mesh.points(), wanted, room)?;
        if added.is_empty() {
            return Ok(Refined { cover, coefficients, rounds, is_reached });
        }
        places = cover.mesh.points().to_vec();
        places.extend(added);
    }
}

/// A fit over the knots of a round.
struct Solution {
    coefficients: Vec<f64>,
    /// Observations whose residual is greater, for a weight of one, are rejected.
    limit: f64,
}

impl Solution {
    fn of<O: Observations + ?Sized>(
        cover: &Cover,
        observations: &O,
        goal: &Goal,
        threads: NonZeroUsize,
    ) -> Result<Solution> {
        let normal = Normal::of(&cover.basis, observations, threads)?;
        let energy = bending(&cover.basis)?;
        let (basis, energy) = (&cover.basis, Some(&energy));
        let lambda = goal.smoothing * normal.halving(basis);
        let Some(loss) = goal.loss else {
            let coefficients = Equations::new(basis, &normal, energy)?.solve(lambda)?;
            return Ok(Solution { coefficients, limit: f64::INFINITY });
        };
        let rounds = Rounds { basis, observations, energy, lambda, threads, most: ROUNDS_FEW };
        let fit = rounds.fit(loss, &normal)?;
        Ok(Solution { limit: fit.limit(), coefficients: fit.coefficients })
    }
}

//! Residuals of one round of the search for knots, triangle by triangle, and the next knots.
//!
//! Gross errors would attract knots. So with a loss, fits are robust, and rejected observations cause no knot
//! unless they are a large part of their triangle.

use super::blocks::Observations;
use super::knot_placement::knot_for_residual;
use super::mesh::{Mesh, SplineSpace};
use super::refine::{Goal, Round};
use super::residuals::{self, Residual};
use spmesh_base::error::Result;
use spmesh_base::random::Random;
use spmesh_delaunay::predicates::Point2;
use std::num::NonZeroUsize;

/// Least number of observations in a triangle that gets a knot; a knot adds two or three functions.
const OBSERVATIONS_MIN: u32 = 3;
/// From this part of a triangle's observations on, rejected ones are attributed to a lack of knots, not to
/// gross errors.
const REJECTED_MIN: f64 = 0.25;

/// The residuals of a round in each triangle.
pub(super) struct TriangleResiduals {
    pub(super) round: Round,
    triangles: Vec<Inside>,
}

/// The observations in a triangle.
#[derive(Debug, Clone, Copy, Default)]
struct Inside {
    observations: u32,
    rejected: u32,
    /// The greatest residual above the tolerance, if any: first among observations that are not rejected,
    /// second among those that are.
    worst: [Option<Residual>; 2],
}

impl Inside {
    fn add(&mut self, found: Residual, is_above: bool, is_rejected: bool) {
        self.observations = self.observations.saturating_add(1);
        self.rejected = self.rejected.saturating_add(u32::from(is_rejected));
        let worst = &mut self.worst[usize::from(is_rejected)];
        if is_above && worst.is_none_or(|worst| found.residual.abs() > worst.residual.abs()) {
            *worst = Some(found);
        }
    }

    /// The observation that a knot is added for. Rejected observations count only if there are many of them
    /// in the triangle.
    fn knot_request(&self) -> Option<Residual> {
        if self.observations < OBSERVATIONS_MIN {
            return None;
        }
        let [worst, rejected] = self.worst;
        let are_many = f64::from(self.rejected) >= REJECTED_MIN * f64::from(self.observations);
        worst.or(rejected.filter(|_| are_many))
    }
}

impl TriangleResiduals {
    pub(super) fn of<O: Observations + ?Sized>(
        space: &SplineSpace,
        coefficients: &[f64],
        limit: f64,
        observations: &O,
        goal: &Goal,
        threads: NonZeroUsize,
    ) -> Result<TriangleResiduals> {
        let mut triangles = vec![Inside::default(); space.mesh.triangles_len()];
        let (mut near, mut above, mut count, mut square, mut greatest) = (0, 0, 0u64, 0.0, 0f64);
        residuals::for_each_residual(&space.basis, coefficients, observations, threads, |found| {
            if found.weight == 0.0 {
                return;
            }
            count += 1;
            square += found.residual * found.residual;
            greatest = greatest.max(found.residual.abs());
            let is_above = found.residual.abs() > goal.tolerance;
            let is_rejected = found.residual.abs() * found.weight.sqrt() > limit;
            above += u64::from(is_above && !is_rejected);
            if let Some(triangle) = space.mesh.locate(found.point, &mut near) {
                triangles[triangle as usize].add(found, is_above, is_rejected);
            }
        })?;
        let round = Round {
            knots: space.mesh.points().len(),
            functions: space.basis.len(),
            greatest,
            root_mean_square: (square / count.max(1) as f64).sqrt(),
            above,
        };
        Ok(TriangleResiduals { round, triangles })
    }

    /// The next knots, for the greatest residuals first; at most as many as there are already.
    pub(super) fn knots(&self, mesh: &Mesh, goal: &Goal) -> Vec<Point2> {
        let candidates = (0u32..)
            .zip(&self.triangles)
            .filter_map(|(triangle, inside)| Some((triangle, inside.knot_request()?)));
        let mut candidates: Vec<(u32, Residual)> = candidates.collect();
        candidates.sort_by(|a, b| b.1.residual.abs().total_cmp(&a.1.residual.abs()).then(a.0.cmp(&b.0)));
        let known = mesh.points().len();
        let added_max = goal.max_knots.saturating_sub(known).min(known);
        let mut added: Vec<Point2> = Vec::new();
        let mut random = Random::new(known as u64);
        for (triangle, worst) in candidates {
            if added.len() >= added_max {
                break;
            }
            let knot = knot_for_residual(mesh, triangle, worst.point, &mut random);
            if !mesh.corners(triangle).contains(&knot) {
                added.push(knot);
            }
        }
        added
    }
}

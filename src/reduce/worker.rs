//! Does jobs, one after the other.

use super::node::{Rules, Solved, Solver};
use super::residual::Residual;
use super::schedule::Job;
use crate::error::Result;
use crate::predicates::PredicateCounts;
use crate::stream::PatchBlocks;

/// A solver with the memory for the union of residuals.
pub(super) struct Worker {
    solver: Solver,
    union: Residual,
}

impl Worker {
    pub(super) fn new(rules: Rules) -> Self {
        Worker { solver: Solver::new(rules), union: Residual::default() }
    }

    /// Triangulates a node. The memory of `blocks` is used again; `give_back` gets the memory of raw points.
    ///
    /// # Errors
    /// As [`Solver::solve`].
    pub(super) fn solve(
        &mut self,
        job: Job,
        blocks: PatchBlocks,
        give_back: impl FnOnce(Residual),
    ) -> Result<Solved> {
        let Job { number, region, mut raw, parts, .. } = job;
        if parts.is_empty() {
            let solved = self.solver.solve(number, &mut raw, &region, blocks);
            raw.clear();
            give_back(raw);
            return solved;
        }
        self.union.clear();
        self.union.append_raw(&raw);
        for part in parts {
            self.union.append(&part);
        }
        self.solver.solve(number, &mut self.union, &region, blocks)
    }

    /// Decisions of the predicates so far.
    pub(super) fn counts(&self) -> &PredicateCounts {
        self.solver.counts()
    }
}

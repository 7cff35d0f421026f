//! One worker: triangulates one node after the other.

use super::bulk::Bulk;
use super::duplicates::Merged;
use super::node::{Solved, Solver};
use super::patches::Flush;
use super::residual::{Residual, UNWRITTEN};
use super::rules::Rules;
use super::sample::Sample;
use super::schedule::Job;
use spmesh_base::error::Result;
use spmesh_delaunay::predicates::PredicateCounts;
use spmesh_stream::PatchBlocks;
use std::num::NonZeroUsize;

/// A solver, with the memory for the union of residuals.
pub(super) struct Worker<B, const D: usize> {
    solver: Solver<B, D>,
    sample: Sample<B, D>,
    union: Residual<D>,
}

impl<B: Bulk<D>, const D: usize> Worker<B, D> {
    pub(super) fn new(rules: Rules<D>) -> Self {
        Worker { solver: Solver::new(rules), sample: Sample::new(rules), union: Residual::default() }
    }

    /// Triangulates a node, or passes its points up if the node would leave most of them. The memory of
    /// `blocks` is used again; `give_back` gets the memory of raw points, and `flush`, if there is
    /// one, may take patches as they come.
    pub(super) fn solve(
        &mut self,
        job: Job<D>,
        blocks: PatchBlocks,
        give_back: impl FnOnce(Residual<D>),
        flush: Option<&mut Flush>,
    ) -> Result<Solved<D>> {
        let Job { number, region, is_root, mut raw, parts, spare, .. } = job;
        self.solver.allow(spare);
        self.sample.allow(spare);
        if parts.is_empty() {
            if !is_root && self.sample.leaves_most(&raw, &region)? {
                return Ok(passed_up(raw, blocks));
            }
            let solved = self.solver.solve(number, &mut raw, &region, blocks, flush);
            self.solver.shrink(raw.len());
            raw.clear();
            give_back(raw);
            return solved;
        }
        self.union.clear();
        self.union.append_raw(&raw);
        self.union.unite(parts);
        if !is_root && self.sample.leaves_most(&self.union, &region)? {
            return Ok(passed_up(std::mem::take(&mut self.union), blocks));
        }
        let solved = self.solver.solve(number, &mut self.union, &region, blocks, flush);
        self.solver.shrink(self.union.len());
        // Leaves are about as large as each other, but nodes above them are not.
        if self.union.len() > B::KEPT_POINTS_MAX {
            self.solver.forget();
            self.union = Residual::default();
        }
        solved
    }

    /// Gives the next node so many threads.
    pub(super) fn share(&mut self, threads: NonZeroUsize) {
        self.solver.share(threads);
    }

    /// Decisions of the predicates so far.
    pub(super) fn counts(&self) -> PredicateCounts {
        let mut counts = self.solver.counts();
        counts.merge(self.sample.counts());
        counts
    }
}

/// The result of a node that passes its points up as they are.
fn passed_up<const D: usize>(residual: Residual<D>, mut blocks: PatchBlocks) -> Solved<D> {
    blocks.clear();
    let reference = |(number, &key): (u64, &u64)| if key == UNWRITTEN { UNWRITTEN } else { number };
    let references = (0..).zip(&residual.keys).map(reference).collect();
    Solved { blocks, residual, references, merged: Merged::default() }
}

//! A run under way: the steps that one thread and several have in common.

use std::fmt;
use std::io::Write;
use std::num::NonZeroUsize;

use super::beside::write_beside;
use super::budget::Budget;
use super::bulk::Bulk;
use super::patches::Flush;
use super::reader::{InputSummary, Piece};
use super::residual::union;
use super::rules::Rules;
use super::schedule::{Job, Schedule};
use super::sequencer::{Outputs, Sequencer};
use super::stats::Stats;
use super::worker::Worker;
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_delaunay::predicates::PredicateCounts;
use spmesh_stream::PatchBlocks;
use spmesh_stream::model::cells::CellCode;

/// A run under way, without its input and output.
pub(super) struct Run<const D: usize> {
    /// Name of the input in messages.
    pub(super) name: String,
    /// Levels of the input's tree.
    pub(super) level: u64,
    pub(super) rules: Rules<D>,
    pub(super) schedule: Schedule<D>,
    pub(super) budget: Budget,
    pub(super) threads: NonZeroUsize,
}

impl<const D: usize> Run<D> {
    /// Takes a piece of the input. At its end, returns the totals.
    pub(super) fn take(
        &mut self,
        piece: Piece<D>,
        mut progress: impl FnMut(u64),
    ) -> Result<Option<Box<InputSummary<D>>>> {
        match piece {
            Piece::Read { points, held } => {
                progress(points);
                self.schedule.hold(held);
            }
            Piece::Cell { tagged, held } => {
                self.schedule.hold(held);
                self.schedule.cell(tagged);
            }
            Piece::End(mut ended) => {
                self.schedule.rest(std::mem::take(&mut ended.rest));
                return Ok(Some(ended));
            }
        }
        self.check_memory(0)?;
        Ok(None)
    }

    /// The next node that can be triangulated, except the root.
    pub(super) fn next_job(&mut self) -> Result<Option<Job<D>>> {
        let Some(mut job) = self.schedule.next_job() else { return Ok(None) };
        job.spare = self.check_memory(job.len())? / self.threads.get() as u64;
        Ok(Some(job))
    }

    /// Checks the limit of memory before a node of `next` points is triangulated; what is left, in bytes.
    fn check_memory(&mut self, next: usize) -> Result<u64> {
        self.budget.check(self.schedule.load(), next).map_err(|e| e.of_input(&self.name))
    }

    /// Adds input and cell to an error about points; returns other errors unchanged.
    pub(super) fn locate(&self, error: Error, cell: CellCode) -> Error {
        located(error, format_args!("cell {}", cell.0), &self.name)
    }

    /// Triangulates the root, if it has points, and writes its patches as they come.
    fn write_root<B: Bulk<D>, W: Write + Send>(
        &mut self,
        sequencer: &mut Sequencer<W>,
        worker: &mut Worker<B, D>,
    ) -> Result<()> {
        // All other nodes are done, so the threads are idle. What is left behind has an order that depends on
        // them.
        if !self.rules.is_partial {
            worker.share(self.threads);
        }
        // The residual of a partial run passes through all nodes up to the root of the tree.
        while let Some((mut job, children)) = self.schedule.take_root() {
            job.spare = self.check_memory(job.len())?;
            let (number, cell) = (job.number, job.cell);
            sequencer.open(&children);
            let solve = |flush: &mut Flush| worker.solve(job, PatchBlocks::default(), drop, Some(flush));
            let solved = if self.threads.get() > 1 {
                write_beside(sequencer, solve)
            } else {
                solve(&mut |blocks| sequencer.patches(blocks))
            };
            self.schedule.solved(number, solved.map_err(|e| self.locate(e, cell))?);
            // One node with points, followed by the nodes above it, which have none.
            while let Some(output) = self.schedule.next_output() {
                sequencer.close(output)?;
            }
        }
        Ok(())
    }

    /// Finishes when all nodes but the root are written: `worker` triangulates the root. `counts` are the
    /// decisions of other workers.
    pub(super) fn finish<B: Bulk<D>, W: Write + Send>(
        mut self,
        ended: &InputSummary<D>,
        mut sequencer: Sequencer<W>,
        mut worker: Worker<B, D>,
        counts: &PredicateCounts,
    ) -> Result<(Outputs<W>, Stats)> {
        self.write_root(&mut sequencer, &mut worker)?;
        let mut predicates = worker.counts();
        predicates.merge(counts);
        let is_partial = self.rules.is_partial;
        let (numbers, residuals, mut stats) = self.schedule.into_residual();
        if is_partial {
            let residual = union(residuals);
            stats.residual = residual.len() as u64;
            sequencer.write_residual(&numbers, &residual)?;
        }
        sequencer.add_to(&mut stats);
        stats.level = self.level;
        stats.points = ended.accepted;
        stats.count(ended.merged);
        stats.outside = ended.outside;
        stats.held_max = ended.held_max as u64;
        stats.cells = ended.cells;
        stats.input_bytes = ended.input_bytes;
        stats.predicates = predicates;
        let outputs = sequencer.end(stats.points, stats.merged, stats.merged)?;
        Ok((outputs, stats))
    }
}

/// Adds the input and a place in it to an error about points; returns other errors unchanged.
pub(super) fn located(error: Error, place: fmt::Arguments, input: &str) -> Error {
    match error.kind() {
        ErrorKind::Malformed => error.at(place.to_string()).of_input(input),
        ErrorKind::Memory => error.of_input(input),
        _ => error,
    }
}

//! Leaves are triangulated ahead by workers, and come back in the order in which they were submitted.

use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread::{Scope, ScopedJoinHandle};

use crossbeam_channel::{Receiver, Sender, unbounded};

use super::node::{Rules, Solved, Solver};
use super::residual::Residual;
use crate::bounds::Region;
use crate::cells::CellCode;
use crate::error::{Error, ErrorKind, Result};
use crate::predicates::PredicateCounts;

/// Leaves that each worker may have waiting besides the one it works on.
const AHEAD_PER_WORKER: usize = 2;

struct Job {
    number: u64,
    points: Residual,
    region: Region,
}

type Done = (u64, Result<Solved>);

/// A solver for the coordinator and, with more than one thread, workers that solve leaves ahead.
///
/// Leaves do not depend on each other, nor on what is written; so what comes out, and in which order, does
/// not depend on the number of workers.
pub(super) struct Pool<'scope> {
    rules: Rules,
    solver: Solver,
    workers: Vec<ScopedJoinHandle<'scope, PredicateCounts>>,
    jobs: Option<Sender<Job>>,
    done: Receiver<Done>,
    /// Leaves in order of submission; the first has number `first`.
    slots: VecDeque<(CellCode, Option<Result<Solved>>)>,
    first: u64,
}

impl<'scope> Pool<'scope> {
    /// Starts `threads - 1` workers; the coordinator is the remaining thread.
    pub(super) fn start<'env>(scope: &'scope Scope<'scope, 'env>, threads: usize, rules: Rules) -> Self {
        let (jobs, jobs_out) = unbounded::<Job>();
        let (done_in, done) = unbounded();
        let worker = |_| {
            let (jobs, done) = (jobs_out.clone(), done_in.clone());
            scope.spawn(move || work(&jobs, &done, rules))
        };
        let workers = (1..threads).map(worker).collect();
        let solver = Solver::default();
        Pool { rules, solver, workers, jobs: Some(jobs), done, slots: VecDeque::new(), first: 0 }
    }

    /// Triangulates a node now, on the calling thread.
    pub(super) fn solve(&mut self, points: Residual, region: &Region) -> Result<Solved> {
        self.solver.solve(points, region, &self.rules)
    }

    /// Takes a leaf to be triangulated.
    ///
    /// # Errors
    /// If the workers are gone.
    pub(super) fn submit(&mut self, cell: CellCode, points: Residual, region: Region) -> Result<()> {
        let number = self.first + self.slots.len() as u64;
        if points.is_empty() {
            self.slots.push_back((cell, Some(Ok(Solved::default()))));
        } else if self.workers.is_empty() {
            let solved = self.solve(points, &region);
            self.slots.push_back((cell, Some(solved)));
        } else {
            self.slots.push_back((cell, None));
            let jobs = self.jobs.as_ref().ok_or_else(workers_gone)?;
            jobs.send(Job { number, points, region }).map_err(|_| workers_gone())?;
        }
        Ok(())
    }

    /// The next leaf in order of submission, if it is done, or if so many are under way that it has to be
    /// waited for; with `wait_for_all`, as long as there is one.
    ///
    /// # Errors
    /// If the workers are gone.
    pub(super) fn next(&mut self, wait_for_all: bool) -> Result<Option<(CellCode, Result<Solved>)>> {
        let ahead = self.workers.len() * (1 + AHEAD_PER_WORKER);
        loop {
            for (number, solved) in self.done.try_iter() {
                self.slots[(number - self.first) as usize].1 = Some(solved);
            }
            match self.slots.front() {
                None => return Ok(None),
                Some((_, Some(_))) => break,
                Some((_, None)) if !wait_for_all && self.slots.len() <= ahead => return Ok(None),
                Some((_, None)) => {
                    let (number, solved) = self.done.recv().map_err(|_| workers_gone())?;
                    self.slots[(number - self.first) as usize].1 = Some(solved);
                }
            }
        }
        self.first += 1;
        Ok(self.slots.pop_front().and_then(|(cell, solved)| Some((cell, solved?))))
    }

    /// Ends the workers; the decisions of all predicates.
    ///
    /// # Errors
    /// If a worker ended by a panic.
    pub(super) fn finish(mut self) -> Result<PredicateCounts> {
        self.jobs = None;
        let mut counts = *self.solver.counts();
        for worker in std::mem::take(&mut self.workers) {
            counts.merge(&worker.join().map_err(|_| workers_gone())?);
        }
        Ok(counts)
    }
}

fn work(jobs: &Receiver<Job>, done: &Sender<Done>, rules: Rules) -> PredicateCounts {
    let mut solver = Solver::default();
    for Job { number, points, region } in jobs {
        // A panic must reach the coordinator, which would wait for this leaf forever.
        let solve = AssertUnwindSafe(|| solver.solve(points, &region, &rules));
        let solved = catch_unwind(solve).unwrap_or_else(|_| Err(workers_gone()));
        let is_lost = solved.is_err();
        if done.send((number, solved)).is_err() || is_lost {
            break;
        }
    }
    *solver.counts()
}

fn workers_gone() -> Error {
    Error::new(ErrorKind::Io, "a worker thread ended before its time")
}

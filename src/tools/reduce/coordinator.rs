//! A run on several threads: one reads, several triangulate, one writes, and the calling one says who does what.
//!
//! No channel that anyone waits for has a limit of its own, but that of the arrivals: so many points are under way at
//! most, from the moment in which their node can be triangulated to that in which it is written, or at once passes them
//! up. What is under way needs nothing that still has to arrive, so it always comes to an end, and no thread waits for one
//! that waits for it.

use std::io::{Read, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread::{Builder, Scope, ScopedJoinHandle};

use crossbeam_channel::{Receiver, Sender, bounded, never, select, select_biased, unbounded};

use super::bulk::Bulk;
use super::node::{Rules, Solved};
use super::reader::{Arrival, Ended, Intake};
use super::residual::Residual;
use super::run::Run;
use super::schedule::{Job, Output};
use super::sequencer::Sequencer;
use super::stats::Stats;
use super::worker::Worker;
use spmesh_core::error::{Error, ErrorKind, Result};
use spmesh_geometry::predicates::PredicateCounts;
use spmesh_model::cells::CellCode;
use spmesh_stream::PatchBlocks;

/// Points under way per thread that triangulates, beyond which no more are taken in.
const POINTS_PER_WORKER: usize = 1 << 16;

/// Nodes that wait for a thread or have one, per thread that triangulates, beyond which no cells are taken in.
const JOBS_PER_WORKER: usize = 3;

/// Cells that are read ahead.
const ARRIVALS_AHEAD: usize = 3;

/// Buffers that wait to be used again.
const SHELF_LEN: usize = 16;

/// Bytes of blocks that are worth to be kept: after a few large nodes, all of them would be as large.
const SHELVED_BLOCKS: usize = 4 << 20;

/// Runs `run` with `workers` threads that triangulate, and at last the root, when they have ended, on the calling one.
pub(super) fn run<B, R, W, const D: usize>(
    run: Run<D>,
    intake: Intake<R, D>,
    sequencer: Sequencer<W>,
    workers: usize,
    progress: impl FnMut(u64),
) -> Result<(W, Stats)>
where
    B: Bulk<D>,
    R: Read + Send + 'static,
    W: Write + Send,
{
    let shelf = Shelf::new();
    let (arrivals_in, arrivals) = bounded(ARRIVALS_AHEAD);
    let raw = shelf.clone();
    // Not in the scope: after a failure, nobody waits for an input that says nothing.
    let read = move || read(intake, &arrivals_in, &raw);
    Builder::new().name("reader".into()).spawn(read).map_err(no_thread)?;
    std::thread::scope(move |scope| {
        let (crew, hands) = Crew::start::<B, D>(scope, sequencer, run.rules, workers, &shelf)?;
        // What lies on it is freed with the last of the threads, before the root is triangulated.
        drop(shelf);
        crew.coordinate::<B, D>(run, hands, &arrivals, workers, progress)
    })
}

/// Memory to be used again, of raw points and of blocks.
#[derive(Clone)]
struct Shelf<const D: usize> {
    raw: (Sender<Residual<D>>, Receiver<Residual<D>>),
    blocks: (Sender<PatchBlocks>, Receiver<PatchBlocks>),
}

impl<const D: usize> Shelf<D> {
    fn new() -> Self {
        Shelf { raw: bounded(SHELF_LEN), blocks: bounded(SHELF_LEN) }
    }

    fn keep_blocks(&self, blocks: PatchBlocks) {
        if blocks.capacity() <= SHELVED_BLOCKS {
            drop(self.blocks.0.try_send(blocks));
        }
    }
}

/// Reads until the end, a failure, or until nobody wants to know.
fn read<R: Read, const D: usize>(
    mut intake: Intake<R, D>,
    arrivals: &Sender<Result<Arrival<D>>>,
    shelf: &Shelf<D>,
) {
    loop {
        let arrival = intake.next(|| shelf.raw.1.try_recv().unwrap_or_default());
        let is_last = matches!(arrival, Ok(Arrival::End(_)) | Err(_));
        if arrivals.send(arrival).is_err() || is_last {
            return;
        }
    }
}

/// What a worker has done.
struct Done<const D: usize> {
    number: u64,
    cell: CellCode,
    /// Number of its points.
    points: usize,
    solved: Result<Solved<D>>,
}

/// Does jobs until there are no more or one fails; those that are not leaves first, because others wait for them.
fn work<const D: usize>(
    mut solve: impl FnMut(Job<D>) -> Result<Solved<D>>,
    inner: &Receiver<Job<D>>,
    leaves: &Receiver<Job<D>>,
    done: &Sender<Done<D>>,
) {
    loop {
        let job = select_biased! {
            recv(inner) -> job => job,
            recv(leaves) -> job => job,
        };
        let Ok(job) = job else { return };
        let (number, cell, points) = (job.number, job.cell, job.len());
        // A panic must reach the coordinator, which would wait for this node forever.
        let solved = catch_unwind(AssertUnwindSafe(|| solve(job))).unwrap_or_else(|_| Err(thread_gone()));
        let is_lost = solved.is_err();
        if done.send(Done { number, cell, points, solved }).is_err() || is_lost {
            return;
        }
    }
}

/// Writes until there is no more; says of each node that has patches that it is written.
fn write<W: Write, const D: usize>(
    mut sequencer: Sequencer<W>,
    outputs: &Receiver<Output<D>>,
    written: &Sender<usize>,
    shelf: &Shelf<D>,
) -> Result<Sequencer<W>> {
    for output in outputs {
        let (points, has_patches) = (output.points, output.solved.has_patches());
        shelf.keep_blocks(sequencer.write(output)?);
        if has_patches {
            // Only a failure elsewhere makes the coordinator stop listening.
            let _ = written.send(points);
        }
    }
    Ok(sequencer)
}

/// The threads under the coordinator, to be joined.
struct Crew<'scope, W: Write> {
    workers: Vec<ScopedJoinHandle<'scope, PredicateCounts>>,
    writer: ScopedJoinHandle<'scope, Result<Sequencer<W>>>,
}

/// The coordinator's ends of the channels. Dropping them ends the threads.
struct Hands<const D: usize> {
    inner: Sender<Job<D>>,
    leaves: Sender<Job<D>>,
    done: Receiver<Done<D>>,
    outputs: Sender<Output<D>>,
    written: Receiver<usize>,
}

impl<'scope, W: Write + Send + 'scope> Crew<'scope, W> {
    fn start<B: Bulk<D>, const D: usize>(
        scope: &'scope Scope<'scope, '_>,
        sequencer: Sequencer<W>,
        rules: Rules,
        workers: usize,
        shelf: &Shelf<D>,
    ) -> Result<(Self, Hands<D>)> {
        let (inner, inner_out) = unbounded();
        let (leaves, leaves_out) = unbounded();
        let (done_in, done) = unbounded();
        let (outputs, outputs_out) = unbounded();
        let (written_in, written) = unbounded();
        let worker = |number| {
            let (inner, leaves, done) = (inner_out.clone(), leaves_out.clone(), done_in.clone());
            let shelf = shelf.clone();
            let work = move || {
                let mut worker = Worker::<B, D>::new(rules);
                let solve = |job| {
                    let blocks = shelf.blocks.1.try_recv().unwrap_or_default();
                    worker.solve(job, blocks, |raw| drop(shelf.raw.0.try_send(raw)), &mut |_| Ok(()))
                };
                work(solve, &inner, &leaves, &done);
                worker.counts()
            };
            Builder::new().name(format!("worker {number}")).spawn_scoped(scope, work).map_err(no_thread)
        };
        let workers = (0..workers).map(worker).collect::<Result<_>>()?;
        let shelf = shelf.clone();
        let write = move || write(sequencer, &outputs_out, &written_in, &shelf);
        let writer = Builder::new().name("writer".into()).spawn_scoped(scope, write).map_err(no_thread)?;
        Ok((Crew { workers, writer }, Hands { inner, leaves, done, outputs, written }))
    }

    /// Runs until all is written, and ends the threads.
    fn coordinate<B: Bulk<D>, const D: usize>(
        self,
        mut run: Run<D>,
        hands: Hands<D>,
        arrivals: &Receiver<Result<Arrival<D>>>,
        workers: usize,
        progress: impl FnMut(u64),
    ) -> Result<(W, Stats)> {
        let rules = run.rules;
        let ended = hand_out(&mut run, &hands, arrivals, workers, progress);
        drop(hands);
        let writer = self.writer.join().map_err(|_| thread_gone());
        let counts: Vec<_> = self.workers.into_iter().map(ScopedJoinHandle::join).collect();
        // That a thread has gone is the consequence of a failure elsewhere, if there is another one.
        let (ended, sequencer) = match (ended, writer) {
            (Err(Stop::Failed(error)), _) => return Err(error),
            (_, Ok(Err(error)) | Err(error)) => return Err(error),
            (Err(Stop::ThreadGone), _) => return Err(thread_gone()),
            (Ok(ended), Ok(Ok(sequencer))) => (ended, sequencer),
        };
        let mut all = PredicateCounts::default();
        for counts in counts {
            all.merge(&counts.map_err(|_| thread_gone())?);
        }
        run.finish(&ended, sequencer, Worker::<B, D>::new(rules), &all)
    }
}

/// Why the coordinator stops.
enum Stop {
    Failed(Error),
    ThreadGone,
}

/// The coordinator: hands out what can be triangulated and what can be written, until everything is written.
fn hand_out<const D: usize>(
    run: &mut Run<D>,
    hands: &Hands<D>,
    arrivals: &Receiver<Result<Arrival<D>>>,
    workers: usize,
    mut progress: impl FnMut(u64),
) -> std::result::Result<Box<Ended<D>>, Stop> {
    let nothing = never();
    let (mut jobs, mut nodes, mut points, mut ended) = (0, 0, 0, None);
    loop {
        while let Some(job) = run.schedule.next_job() {
            nodes += 1;
            jobs += 1;
            points += job.len();
            let hand = if job.is_leaf() { &hands.leaves } else { &hands.inner };
            hand.send(job).map_err(|_| Stop::ThreadGone)?;
        }
        while let Some(output) = run.schedule.next_output() {
            hands.outputs.send(output).map_err(|_| Stop::ThreadGone)?;
        }
        if nodes == 0
            && let Some(ended) = ended
        {
            return Ok(ended);
        }
        let has_room =
            jobs < JOBS_PER_WORKER * workers && (nodes <= workers || points < workers * POINTS_PER_WORKER);
        let arrivals = if ended.is_none() && has_room { arrivals } else { &nothing };
        select! {
            recv(hands.done) -> done => {
                let Done { number, cell, points: solved_points, solved } = done.map_err(|_| Stop::ThreadGone)?;
                let solved = solved.map_err(|e| Stop::Failed(run.locate(e, cell)))?;
                jobs -= 1;
                if !solved.has_patches() {
                    // Nothing to be written: what it passes up must not hold others up until its turn comes.
                    points -= solved_points;
                    nodes -= 1;
                }
                run.schedule.solved(number, solved);
            }
            recv(hands.written) -> written => {
                points -= written.map_err(|_| Stop::ThreadGone)?;
                nodes -= 1;
            }
            recv(arrivals) -> arrival => {
                let arrival = arrival.map_err(|_| Stop::ThreadGone)?.map_err(Stop::Failed)?;
                ended = run.take(arrival, &mut progress);
            }
        }
    }
}

fn thread_gone() -> Error {
    Error::new(ErrorKind::Io, "a thread ended before its time")
}

fn no_thread(cause: std::io::Error) -> Error {
    Error::io("starting a thread", cause)
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_model::bounds::Region;

    #[test]
    fn a_panic_is_the_result_of_its_job() {
        let (jobs, jobs_out) = unbounded();
        let (done_in, done) = unbounded();
        for number in 0..2 {
            let (cell, region) = (CellCode::ROOT, Region::PLANE);
            jobs.send(Job {
                number,
                cell,
                region,
                is_root: true,
                raw: Residual::default(),
                parts: Vec::new(),
            })
            .unwrap();
        }
        work(|job| panic!("of the test, at job {}", job.number), &never(), &jobs_out, &done_in);
        let done: Vec<Done<2>> = done.try_iter().collect();
        assert_eq!(done.len(), 1, "a worker that has failed does nothing more");
        assert_eq!(done[0].number, 0);
        assert_eq!(done[0].solved.as_ref().unwrap_err().kind(), ErrorKind::Io);
    }
}

//! A run on several threads: one reads, several triangulate, one writes, and the calling thread coordinates
//! them.
//!
//! Only the reader's channel is bounded; it alone applies back-pressure. The coordinator receives from it
//! only while few nodes are under way. A node is under way from the moment in which it can be triangulated
//! until it is written, or until it has passed its points up. A node under way needs no further input, so it
//! always comes to an end, and no two threads wait for each other.
//!
//! The threads, the reader and the buffer pools come from [`spmesh_base::parallel`]. The coordinator does
//! not, because no shape there fits: results make new jobs, jobs have two priorities, and a third thread
//! reports what is written.

use std::io::{Read, Write};
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread::{Scope, ScopedJoinHandle};

use crossbeam_channel::{Receiver, Sender, never, select, select_biased, unbounded};

use super::bulk::Bulk;
use super::node::Solved;
use super::reader::{CellReader, InputSummary, Piece};
use super::residual::Residual;
use super::rules::Rules;
use super::run_state::Run;
use super::schedule::{Job, Output};
use super::sequencer::{Outputs, Sequencer};
use super::stats::Stats;
use super::worker::Worker;
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::parallel::{self, BufferPool};
use spmesh_delaunay::predicates::PredicateCounts;
use spmesh_stream::PatchBlocks;
use spmesh_stream::model::cells::CellCode;

/// Points under way per worker from which the coordinator takes no more input.
const POINTS_PER_WORKER: usize = 1 << 16;

/// Nodes per worker, waiting or being triangulated, from which the coordinator takes no more input.
const JOBS_PER_WORKER: usize = 3;

/// Batches of pieces of the input that are read ahead.
const BATCHES_AHEAD: usize = 2;

/// Points of a batch, of which each piece counts as a few. Larger pieces come alone.
const BATCH_POINTS: usize = 1 << 12;
const PIECE_POINTS_MIN: usize = 1 << 5;

/// Nodes of up to so many points are triangulated by the coordinator: to hand them over would take longer.
const SMALL: usize = 64;

/// Buffers of each kind that wait to be used again.
const POOL_LEN: usize = 16;

/// Runs `run` with `workers` threads that triangulate. The calling thread triangulates the root when they
/// have ended.
pub(super) fn run<B, R, W, const D: usize>(
    run: Run<D>,
    mut reader: CellReader<R, D>,
    sequencer: Sequencer<W>,
    workers: usize,
    progress: impl FnMut(u64),
) -> Result<(Outputs<W>, Stats)>
where
    B: Bulk<D>,
    R: Read + Send + 'static,
    W: Write + Send,
{
    let buffers = Buffers::new(B::KEPT_BLOCKS_MAX);
    let raw = buffers.raw.clone();
    let next = move || next_batch(&mut reader, &raw);
    // Started outside of the scope: a failure must not wait for an input that stays silent.
    let batches = parallel::produce("reader", BATCHES_AHEAD, next)?;
    std::thread::scope(move |scope| {
        let (pool, channels) = WorkerPool::start::<B, D>(scope, sequencer, run.rules, workers, &buffers)?;
        // The buffers are then freed with the last of the threads, before the root is triangulated.
        drop(buffers);
        pool.coordinate::<B, D>(run, channels, &batches, workers, progress)
    })
}

/// Pieces of the input, the last of which may be an error.
type Batch<const D: usize> = Vec<Result<Piece<D>>>;

/// The next pieces of the input: one that is large, or several of one block. The input may be silent after
/// it, and must not hold them back.
fn next_batch<R: Read, const D: usize>(
    reader: &mut CellReader<R, D>,
    raw: &BufferPool<Residual<D>>,
) -> ControlFlow<Batch<D>, Batch<D>> {
    let (mut batch, mut points, mut fresh) = (Vec::new(), 0, || raw.take());
    let mut next = Some(reader.next(&mut fresh));
    while let Some(piece) = next.take() {
        points += match &piece {
            Ok(Piece::Cell { tagged, .. }) => tagged.points.len().max(PIECE_POINTS_MIN),
            Ok(Piece::Read { .. }) => BATCH_POINTS,
            Ok(Piece::End(_)) | Err(_) => {
                batch.push(piece);
                return ControlFlow::Break(batch);
            }
        };
        batch.push(piece);
        if points < BATCH_POINTS {
            next = reader.next_read(&mut fresh).transpose();
        }
    }
    ControlFlow::Continue(batch)
}

/// Memory to be used again, of raw points and of blocks.
#[derive(Clone)]
struct Buffers<const D: usize> {
    raw: BufferPool<Residual<D>>,
    blocks: BufferPool<PatchBlocks>,
    /// Capacity up to which blocks are kept, in bytes: without a limit, all of them would grow to the size of
    /// the largest nodes.
    blocks_max: usize,
}

impl<const D: usize> Buffers<D> {
    fn new(blocks_max: usize) -> Self {
        Buffers { raw: BufferPool::new(POOL_LEN), blocks: BufferPool::new(POOL_LEN), blocks_max }
    }

    fn give_back_blocks(&self, blocks: PatchBlocks) {
        if blocks.capacity() <= self.blocks_max {
            self.blocks.give_back(blocks);
        }
    }
}

/// The result of a job.
struct Done<const D: usize> {
    number: u64,
    cell: CellCode,
    /// Number of points of the node.
    points: usize,
    solved: Result<Solved<D>>,
}

/// Does jobs until there are no more or one fails. Inner nodes come before leaves, because other nodes wait
/// for them.
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
        let has_failed = solved.is_err();
        if done.send(Done { number, cell, points, solved }).is_err() || has_failed {
            return;
        }
    }
}

/// Nodes with patches that are under way, or were written.
#[derive(Clone, Copy, Default)]
struct UnderWay {
    nodes: usize,
    points: usize,
    /// Bytes of patches beyond what points usually have.
    bytes: usize,
}

impl UnderWay {
    fn add(&mut self, points: usize, bytes: usize) {
        self.nodes += 1;
        self.points += points;
        self.bytes += bytes;
    }

    fn subtract(&mut self, other: UnderWay) {
        self.nodes -= other.nodes;
        self.points -= other.points;
        self.bytes -= other.bytes;
    }
}

/// Writes nodes until there are no more, and reports those that have patches.
fn write<W: Write, const D: usize>(
    mut sequencer: Sequencer<W>,
    outputs: &Receiver<Vec<Output<D>>>,
    written: &Sender<UnderWay>,
    buffers: &Buffers<D>,
) -> Result<Sequencer<W>> {
    for outputs in outputs {
        let mut done = UnderWay::default();
        for output in outputs {
            if output.solved.has_patches() {
                done.add(output.points, output.bytes_beyond());
            }
            buffers.give_back_blocks(sequencer.write(output)?);
        }
        if done.nodes > 0 {
            // The coordinator stops listening only after a failure elsewhere.
            let _ = written.send(done);
        }
    }
    Ok(sequencer)
}

/// The threads that triangulate and the one that writes, to be joined.
struct WorkerPool<'scope, W: Write> {
    workers: Vec<ScopedJoinHandle<'scope, PredicateCounts>>,
    writer: ScopedJoinHandle<'scope, Result<Sequencer<W>>>,
}

/// The coordinator's ends of the channels. Dropping them ends the threads.
struct Channels<const D: usize> {
    inner: Sender<Job<D>>,
    leaves: Sender<Job<D>>,
    done: Receiver<Done<D>>,
    outputs: Sender<Vec<Output<D>>>,
    written: Receiver<UnderWay>,
}

impl<'scope, W: Write + Send + 'scope> WorkerPool<'scope, W> {
    /// Starts the threads.
    fn start<B: Bulk<D>, const D: usize>(
        scope: &'scope Scope<'scope, '_>,
        sequencer: Sequencer<W>,
        rules: Rules<D>,
        workers: usize,
        buffers: &Buffers<D>,
    ) -> Result<(Self, Channels<D>)> {
        let (inner, inner_out) = unbounded();
        let (leaves, leaves_out) = unbounded();
        let (done_in, done) = unbounded();
        let (outputs, outputs_out) = unbounded();
        let (written_in, written) = unbounded();
        let worker = |number| {
            let (inner, leaves, done) = (inner_out.clone(), leaves_out.clone(), done_in.clone());
            let buffers = buffers.clone();
            let work = move || {
                let mut worker = Worker::<B, D>::new(rules);
                let solve = |job| {
                    let give_back = |raw| buffers.raw.give_back(raw);
                    worker.solve(job, buffers.blocks.take(), give_back, None)
                };
                work(solve, &inner, &leaves, &done);
                worker.counts()
            };
            parallel::spawn_scoped(scope, format!("worker {number}"), work)
        };
        let workers = (0..workers).map(worker).collect::<Result<_>>()?;
        let buffers = buffers.clone();
        let write = move || write(sequencer, &outputs_out, &written_in, &buffers);
        let writer = parallel::spawn_scoped(scope, "writer", write)?;
        Ok((WorkerPool { workers, writer }, Channels { inner, leaves, done, outputs, written }))
    }

    /// Runs until everything is written, ends the threads, and finishes with the root.
    fn coordinate<B: Bulk<D>, const D: usize>(
        self,
        mut run: Run<D>,
        channels: Channels<D>,
        batches: &Receiver<Batch<D>>,
        workers: usize,
        progress: impl FnMut(u64),
    ) -> Result<(Outputs<W>, Stats)> {
        let rules = run.rules;
        let mut small = Worker::<B, D>::new(rules);
        let ended = dispatch(&mut run, &mut small, &channels, batches, workers, progress);
        drop(channels);
        let writer = self.writer.join().map_err(|_| thread_gone());
        let counts: Vec<_> = self.workers.into_iter().map(ScopedJoinHandle::join).collect();
        // If there is another failure, the missing thread is its consequence.
        let (ended, sequencer) = match (ended, writer) {
            (Err(Stop::Failed(error)), _) => return Err(error),
            (_, Ok(Err(error)) | Err(error)) => return Err(error),
            (Err(Stop::ThreadGone), _) => return Err(thread_gone()),
            (Ok(ended), Ok(Ok(sequencer))) => (ended, sequencer),
        };
        let mut all = small.counts();
        drop(small);
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

/// The coordinator's loop: passes on nodes that can be triangulated or written, until all are written.
fn dispatch<B: Bulk<D>, const D: usize>(
    run: &mut Run<D>,
    small: &mut Worker<B, D>,
    channels: &Channels<D>,
    batches: &Receiver<Batch<D>>,
    workers: usize,
    mut progress: impl FnMut(u64),
) -> std::result::Result<Box<InputSummary<D>>, Stop> {
    let nothing = never();
    let (mut jobs, mut under_way, mut ended) = (0, UnderWay::default(), None);
    loop {
        while let Some(job) = run.next_job().map_err(Stop::Failed)? {
            if job.len() <= SMALL {
                solve_small(run, small, job, &mut under_way).map_err(Stop::Failed)?;
                continue;
            }
            under_way.add(job.len(), 0);
            jobs += 1;
            let queue = if job.is_leaf() { &channels.leaves } else { &channels.inner };
            queue.send(job).map_err(|_| Stop::ThreadGone)?;
        }
        let outputs: Vec<_> = std::iter::from_fn(|| run.schedule.next_output()).collect();
        if !outputs.is_empty() {
            channels.outputs.send(outputs).map_err(|_| Stop::ThreadGone)?;
        }
        if under_way.nodes == 0
            && let Some(ended) = ended
        {
            return Ok(ended);
        }
        run.schedule.hold_patches(under_way.bytes);
        let UnderWay { nodes, points, .. } = under_way;
        let takes_input =
            jobs < JOBS_PER_WORKER * workers && (nodes <= workers || points < workers * POINTS_PER_WORKER);
        let batches = if ended.is_none() && takes_input { batches } else { &nothing };
        select! {
            recv(channels.done) -> done => {
                let Done { number, cell, points, solved } = done.map_err(|_| Stop::ThreadGone)?;
                let solved = solved.map_err(|e| Stop::Failed(run.locate(e, cell)))?;
                jobs -= 1;
                if !solved.has_patches() {
                    // Without patches, the node counts as done at once: otherwise it would hold back input
                    // until its turn to be written, although writing it does nothing.
                    under_way.subtract(UnderWay { nodes: 1, points, bytes: 0 });
                }
                under_way.bytes += solved.bytes_beyond(points);
                run.schedule.solved(number, solved);
            }
            recv(channels.written) -> written => {
                under_way.subtract(written.map_err(|_| Stop::ThreadGone)?);
            }
            recv(batches) -> batch => {
                for piece in batch.map_err(|_| Stop::ThreadGone)? {
                    let taken = piece.and_then(|piece| run.take(piece, &mut progress));
                    ended = taken.map_err(Stop::Failed)?;
                }
            }
        }
    }
}

/// Triangulates a small node on this thread.
fn solve_small<B: Bulk<D>, const D: usize>(
    run: &mut Run<D>,
    small: &mut Worker<B, D>,
    job: Job<D>,
    under_way: &mut UnderWay,
) -> Result<()> {
    let (number, cell, points) = (job.number, job.cell, job.len());
    let solved = small.solve(job, PatchBlocks::default(), drop, None);
    let solved = solved.map_err(|error| run.locate(error, cell))?;
    if solved.has_patches() {
        under_way.add(points, solved.bytes_beyond(points));
    }
    run.schedule.solved(number, solved);
    Ok(())
}

pub(super) fn thread_gone() -> Error {
    Error::new(ErrorKind::Io, "a thread ended before its time")
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_stream::model::bounds::Region;

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
                spare: u64::MAX,
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

//! Tetrahedralizes points in overlapping regions: each on one thread, if there is memory for several at once.
//!
//! A region owns the tetrahedra whose circumcentres are in its box. `docs/theory/regions.md` proves that
//! these are the tetrahedra of all points, each once.

use std::collections::HashMap;
use std::io::{Read, Write};
use std::marker::PhantomData;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crossbeam_channel::RecvTimeoutError;

use super::beside::write_beside;
use super::budget::{Budget, Held, Load};
use super::coordinator::thread_gone;
use super::duplicates::Merged;
use super::node::Solver;
use super::patches::Flush;
use super::residual::Residual;
use super::rules::Rules;
use super::run::{Input, Options, begin, check_weights, mesh_header};
use super::run_state::located;
use super::sequencer::{Outputs, Sequencer};
use super::space::Space;
use super::stats::Stats;
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::parallel::{self, InTurn};
use spmesh_delaunay::delaunay3::{Corners, MAX_POINTS};
use spmesh_stream::model::bounds::{Point, Region};
use spmesh_stream::{Event, Header, PatchBlocks, PointRegion, StreamReader};

/// Bytes of a vertex that later regions have, too, with room to grow.
const LIVE_BYTES: usize = 120;

/// Bytes of a point whose region is being tetrahedralized. Its tetrahedra stay where they are until they are
/// written.
const KERNEL_BYTES: usize = 420;

/// A failure is noticed after this time, although the input is silent.
const PATIENCE: Duration = Duration::from_millis(200);

/// A region with its points, of which those of earlier regions lack their keys.
struct Whole {
    number: u64,
    region: PointRegion,
    points: Residual<3>,
    /// Threads that tetrahedralize it, and the bytes that these may take beyond those of the points.
    threads: NonZeroUsize,
    spare: u64,
}

/// A region that waits for earlier ones to be written.
struct Solved {
    whole: Whole,
    owned: Corners,
    merged: Merged,
}

/// What comes next.
enum Next {
    Region(Box<Whole>),
    /// The length of the input.
    End(u64),
}

/// Reads regions.
struct Regions<R: Read> {
    reader: StreamReader<R>,
    budget: Budget,
    /// Regions read so far.
    read: u64,
}

impl<R: Read> Regions<R> {
    /// Checks that a region fits, before its points are read.
    fn check_size(&mut self, region: &PointRegion) -> Result<()> {
        let points = region.points().min(u64::from(u32::MAX)) as usize;
        let load = Load { raw: points, ..Load::default() };
        self.budget.check(load, points).map_err(|error| error.of_input(self.reader.name()))?;
        if points > MAX_POINTS {
            let message = format!("a region of {points} points, the kernel takes at most {MAX_POINTS}");
            let error = Error::new(ErrorKind::Memory, format!("{message}: finalize with smaller regions"));
            return Err(error.of_input(self.reader.name()));
        }
        Ok(())
    }

    /// The next region, or the end.
    fn next(&mut self) -> Result<Next> {
        let mut next: Option<Whole> = None;
        loop {
            if let Some(whole) = next.take_if(|whole| whole.points.len() as u64 == whole.region.points()) {
                return Ok(Next::Region(Box::new(whole)));
            }
            match self.reader.next_event()? {
                Some(Event::Region(region)) => {
                    self.check_size(&region)?;
                    self.read += 1;
                    let (points, threads) = (Residual::default(), NonZeroUsize::MIN);
                    next = Some(Whole { number: self.read, region, points, threads, spare: u64::MAX });
                }
                Some(Event::Points(points)) if points.is_empty() => self.reader.give_back(points),
                Some(Event::Points(points)) => {
                    let whole = next.as_mut().expect("the reader refuses points before the first region");
                    whole.points.extend_raw(&points, self.reader.rows());
                    self.reader.give_back(points);
                }
                Some(Event::End(_)) | None => return Ok(Next::End(self.reader.bytes_read())),
                Some(_) => unreachable!("the reader refuses these blocks in a stream of points in regions"),
            }
        }
    }
}

/// The ids of the vertices that later regions have, too, by their places.
type Live = HashMap<[u64; 3], u64>;

fn key(at: Point) -> [u64; 3] {
    at.map(f64::to_bits)
}

/// Tetrahedralizes points in regions.
pub(super) fn reduce<W: Write + Send>(
    reader: StreamReader<Input>,
    outputs: Outputs<W>,
    options: &Options<3>,
    progress: &mut (dyn FnMut(u64) + Send),
) -> Result<Stats> {
    let header = reader.header();
    if options.part.is_some() {
        let message = "--partial does not go with points in regions: finalize with --regions never";
        return Err(Error::usage(message));
    }
    check_weights(header, options)?;
    let mesh = Header { compressed: options.compress, ..mesh_header::<Space, 3>(header, None, None) };
    let (row_len, all) = (header.attributes.row_len(), header.points.unwrap_or(u64::MAX));
    let sequencer = begin::<Space, W, 3>(outputs, mesh, Region::EVERYTHING)?;
    let rules = Rules::new(sequencer.header(), options.duplicates, false);
    let budget = Budget::new::<Space, 3>(options.memory, 1, row_len).of_kernels(KERNEL_BYTES, row_len);
    let name = reader.name().to_string();
    let threads = NonZeroUsize::new(options.threads).unwrap_or(NonZeroUsize::MIN);
    let mut regions = Regions { reader, budget, read: 0 };
    let read = move || match regions.next() {
        Ok(Next::Region(whole)) => ControlFlow::Continue(Ok(Next::Region(whole))),
        last => ControlFlow::Break(last),
    };
    let read = parallel::produce("reader", 0, read)?;
    let is_alone = AtomicBool::new(false);
    let task = Task { threads, all, budget, name: &name, is_alone, writer: PhantomData };
    let mut input_bytes = 0;
    let next = |ends: &AtomicBool| loop {
        match read.recv_timeout(PATIENCE) {
            Ok(Ok(Next::Region(whole))) => return Ok(Some(*whole)),
            Ok(Ok(Next::End(bytes))) => {
                input_bytes = bytes;
                return Ok(None);
            }
            Ok(Err(error)) => return Err(error),
            // The input may stay silent, and there is nothing more to be done for it.
            Err(RecvTimeoutError::Timeout) if ends.load(Ordering::Relaxed) => return Ok(None),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Err(thread_gone()),
        }
    };
    let solvers = (0..threads.get()).map(|_| Solver::new(rules)).collect();
    let run = Run { sequencer, live: Live::default(), stats: Stats::default(), progress };
    let (solvers, run) = parallel::in_turn(&task, solvers, run, next)?;
    let Run { mut stats, sequencer, live, .. } = run;
    if let Some(at) = live.keys().min() {
        let at = at.map(f64::from_bits);
        let message = format!("point {at:?} is shared with a later region, and in none");
        return Err(Error::malformed(message).of_input(name));
    }
    sequencer.add_to(&mut stats);
    stats.input_bytes = input_bytes;
    solvers.iter().for_each(|solver| stats.predicates.merge(&solver.counts()));
    sequencer.end(stats.points, stats.merged, stats.merged)?;
    Ok(stats)
}

/// What is done with regions: several at once, written in their order.
struct Task<'t, W> {
    threads: NonZeroUsize,
    /// Points of the input, if it states them.
    all: u64,
    budget: Budget,
    /// The name of the input.
    name: &'t str,
    /// Whether a region takes all threads and all memory that there is.
    is_alone: AtomicBool,
    writer: PhantomData<fn() -> W>,
}

/// What goes on from one region to the next.
struct Run<'p, W: Write> {
    sequencer: Sequencer<W>,
    live: Live,
    stats: Stats,
    progress: &'p mut (dyn FnMut(u64) + Send),
}

impl<'t, W: Write + Send + 't> InTurn for Task<'t, W> {
    type Item = Whole;
    type Done = Solved;
    type State = Solver<Space, 3>;
    type Shared = Run<'t, W>;

    /// Regions are tetrahedralized at once if there is memory for that; else one after the other, each on all
    /// threads.
    fn admits(&self, whole: &mut Whole, under_way: u64, run: &Run<W>) -> Result<bool> {
        if under_way > 0 && self.is_alone.load(Ordering::Relaxed) {
            return Ok(false);
        }
        let (count, mut budget) = (whole.points.len(), self.budget);
        // The next region is being read.
        let held = Held { points: count, buckets: LIVE_BYTES * run.live.len(), ..Held::default() };
        let mut room = |points: usize| budget.check(Load { held, raw: points, ..Load::default() }, points);
        match room(count + under_way as usize) {
            Ok(spare) => {
                let is_alone = under_way == 0 && (room(2 * count).is_err() || count as u64 > self.all / 2);
                self.is_alone.store(is_alone, Ordering::Relaxed);
                (whole.threads, whole.spare) = match spare {
                    _ if is_alone => (self.threads, spare),
                    u64::MAX => (NonZeroUsize::MIN, u64::MAX),
                    _ => (NonZeroUsize::MIN, spare / self.threads.get() as u64),
                };
                Ok(true)
            }
            Err(_) if under_way > 0 => Ok(false),
            Err(error) => Err(located(error, format_args!("region {}", whole.number), self.name)),
        }
    }

    fn weight(&self, whole: &Whole) -> u64 {
        whole.points.len() as u64
    }

    fn work(&self, solver: &mut Solver<Space, 3>, mut whole: Whole) -> Result<Solved> {
        solver.share(whole.threads);
        solver.allow(whole.spare);
        whole.points.raw = whole.region.new_points() as usize;
        let solved = solver.solve_region(&whole.region, &mut whole.points);
        let (owned, merged) = self.located(solved, whole.number)?;
        Ok(Solved { whole, owned, merged })
    }

    fn finish(&self, solver: &mut Solver<Space, 3>, solved: Solved, run: &mut Run<W>) -> Result<()> {
        let number = solved.whole.number;
        self.located(run.write(solver, solved, self.threads), number)
    }
}

impl<W> Task<'_, W> {
    /// Says in which region an error is.
    fn located<T>(&self, result: Result<T>, number: u64) -> Result<T> {
        result.map_err(|error| located(error, format_args!("region {number}"), self.name))
    }
}

impl<W: Write + Send> Run<'_, W> {
    fn write(&mut self, solver: &mut Solver<Space, 3>, solved: Solved, threads: NonZeroUsize) -> Result<()> {
        let Run { sequencer, live, stats, progress } = self;
        let Solved { whole: Whole { region, mut points, number, .. }, mut owned, merged } = solved;
        enter(&mut points, live)?;
        sequencer.leave(number, points.keys.clone(), 0);
        sequencer.open(&[number]);
        let first = sequencer.vertices();
        let mut blocks = PatchBlocks::default();
        let mut write =
            |flush: &mut Flush| solver.write_region(&region, &points, &mut owned, &mut blocks, flush);
        if threads.get() > 1 {
            write_beside(sequencer, write)
        } else {
            write(&mut |blocks| sequencer.patches(blocks))
        }?;
        sequencer.patches(&mut blocks)?;
        stats.count(merged);
        for v in region.own as u32..region.new_points() as u32 {
            let at = points.at[v as usize];
            if let Some(own) = solver.number_in_region(v, &points)
                && live.insert(key(at), first + own).is_some()
            {
                return Err(Error::malformed(format!("point {at:?} is new, but in an earlier region, too")));
            }
        }
        for &at in &points.at[points.len() - region.last as usize..] {
            live.remove(&key(at));
        }
        stats.points += region.new_points();
        stats.leaves += 1;
        stats.leaf_max = stats.leaf_max.max(points.len() as u64);
        stats.held_max = stats.held_max.max(live.len() as u64);
        progress(stats.points);
        Ok(())
    }
}

/// Gives the points of earlier regions the ids of their vertices.
fn enter(points: &mut Residual<3>, live: &Live) -> Result<()> {
    for &at in &points.at[points.raw..] {
        let Some(&id) = live.get(&key(at)) else {
            return Err(Error::malformed(format!("point {at:?} is in no earlier region")));
        };
        points.keys.push(id);
    }
    Ok(())
}

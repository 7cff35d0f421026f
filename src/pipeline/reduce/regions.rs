//! Tetrahedralizes points in overlapping regions: one region after the other, each on all threads.
//!
//! A region owns the tetrahedra whose circumcentres are in its box. `docs/theory/regions.md` proves that
//! these are the tetrahedra of all points, each once.

use std::collections::HashMap;
use std::io::{Read, Write};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;

use super::beside::write_beside;
use super::budget::{Budget, Held, Load};
use super::coordinator::thread_gone;
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
use spmesh_base::parallel;
use spmesh_delaunay::delaunay3::MAX_POINTS;
use spmesh_stream::model::bounds::{Point, Region};
use spmesh_stream::{Event, Header, PatchBlocks, PointRegion, StreamReader};

/// Bytes of a vertex that later regions have, too, with room to grow.
const LIVE_BYTES: usize = 120;

/// A region with its points, of which those of earlier regions lack their keys.
struct Whole {
    number: u64,
    region: PointRegion,
    points: Residual<3>,
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
            return Err(Error::new(ErrorKind::Memory, format!("{message}: finalize with smaller regions")));
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
                    next = Some(Whole { number: self.read, region, points: Residual::default() });
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

impl Whole {
    /// Gives the points of earlier regions the ids of their vertices.
    fn enter(&mut self, live: &Live) -> Result<()> {
        let new = self.region.new_points() as usize;
        self.points.raw = new;
        for &at in &self.points.at[new..] {
            let Some(&id) = live.get(&key(at)) else {
                return Err(Error::malformed(format!("point {at:?} is in no earlier region")));
            };
            self.points.keys.push(id);
        }
        Ok(())
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
    progress: &mut dyn FnMut(u64),
) -> Result<Stats> {
    let header = reader.header();
    if options.part.is_some() {
        let message = "--partial does not go with points in regions: finalize with --regions never";
        return Err(Error::usage(message));
    }
    check_weights(header, options)?;
    let mesh = Header { compressed: options.compress, ..mesh_header::<Space, 3>(header, None, None) };
    let row_len = header.attributes.row_len();
    let mut sequencer = begin::<Space, W, 3>(outputs, mesh, Region::EVERYTHING)?;
    let rules = Rules::new(sequencer.header(), options.duplicates, false);
    let mut run = Run {
        solver: Solver::new(rules),
        budget: Budget::new::<Space, 3>(options.memory, options.threads, row_len),
        live: Live::default(),
        stats: Stats::default(),
    };
    let threads = NonZeroUsize::new(options.threads).unwrap_or(NonZeroUsize::MIN);
    run.solver.share(threads);
    let name = reader.name().to_string();
    let mut regions = Regions { reader, budget: run.budget, read: 0 };
    let mut next: Box<dyn FnMut() -> Result<Next>> = if threads.get() > 1 {
        let read = move || match regions.next() {
            Ok(Next::Region(whole)) => ControlFlow::Continue(Ok(Next::Region(whole))),
            last => ControlFlow::Break(last),
        };
        let read = parallel::produce("reader", 0, read)?;
        Box::new(move || read.recv().unwrap_or_else(|_| Err(thread_gone())))
    } else {
        Box::new(move || regions.next())
    };
    let input_bytes = loop {
        let whole = match next()? {
            Next::Region(whole) => *whole,
            Next::End(bytes) => break bytes,
        };
        let number = whole.number;
        run.stats.points += whole.region.new_points();
        let solved = run.solve(whole, &mut sequencer, threads);
        solved.map_err(|error| located(error, format_args!("region {number}"), &name))?;
        progress(run.stats.points);
    };
    let Run { mut stats, solver, live, .. } = run;
    if let Some(at) = live.keys().min() {
        let at = at.map(f64::from_bits);
        let message = format!("point {at:?} is shared with a later region, and in none");
        return Err(Error::malformed(message).of_input(name));
    }
    sequencer.add_to(&mut stats);
    stats.input_bytes = input_bytes;
    stats.predicates = solver.counts();
    sequencer.end(stats.points, stats.merged, stats.merged)?;
    Ok(stats)
}

/// What goes on from one region to the next.
struct Run {
    solver: Solver<Space, 3>,
    budget: Budget,
    live: Live,
    stats: Stats,
}

impl Run {
    fn solve<W: Write + Send>(
        &mut self,
        mut whole: Whole,
        sequencer: &mut Sequencer<W>,
        threads: NonZeroUsize,
    ) -> Result<()> {
        let Run { solver, budget, live, stats } = self;
        let count = whole.points.len();
        // The next region is being read.
        let held = Held { points: count, buckets: LIVE_BYTES * live.len(), ..Held::default() };
        solver.allow(budget.check(Load { held, raw: count, ..Load::default() }, count)?);
        whole.enter(live)?;
        let Whole { region, mut points, number } = whole;
        sequencer.leave(number, points.keys.clone(), 0);
        sequencer.open(&[number]);
        let first = sequencer.vertices();
        let mut blocks = PatchBlocks::default();
        let mut solve = |flush: &mut Flush| solver.solve_region(&region, &mut points, &mut blocks, flush);
        let merged = if threads.get() > 1 {
            write_beside(sequencer, solve)
        } else {
            solve(&mut |blocks| sequencer.patches(blocks))
        }?;
        sequencer.patches(&mut blocks)?;
        stats.count(merged);
        let new = region.own as u32..region.new_points() as u32;
        for v in new {
            let at = points.at[v as usize];
            if let Some(own) = solver.number_in_region(v, &points)
                && live.insert(key(at), first + own).is_some()
            {
                return Err(Error::malformed(format!("point {at:?} is new, but in an earlier region, too")));
            }
        }
        for &at in &points.at[count - region.last as usize..] {
            live.remove(&key(at));
        }
        stats.leaves += 1;
        stats.leaf_max = stats.leaf_max.max(count as u64);
        stats.held_max = stats.held_max.max(live.len() as u64);
        Ok(())
    }
}

//! Diagrams of many points in little memory, by a sweep along an axis.
//!
//! The points are cut into slabs. Each stage triangulates a slab and the points that the stages before left.
//! A finite cell that no point beyond the slab can change is *closed*: it is given to the caller and
//! forgotten. Points of other cells are left to the next stage; infinite cells are open until the last. A
//! *wall* is a facet between a closed cell and an open one. In the next stage, cells that are separated from
//! the open ones by walls fill the place of closed ones, and are *spurious*. Walls are facets of cells, whose
//! vertices do not depend on how cells are triangulated. docs/theory/four-dimensions.md proves that.

mod slabs;
mod stage;
mod walls;

use super::exact::Exactness;
use super::simplices::{Coefficient, Simplex, Sphere, triangulate_part};
use super::sites::Sites;
use super::{Stats, merge};
use slabs::{Rest, Slabs};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_stream::model::cells4::Cell4;
use stage::{Stage, State};
use std::num::NonZeroUsize;
use std::time::Instant;

/// How much a stage of a sweep may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Room {
    /// Points of a stage, unless more are left over from the stage before.
    pub points: usize,
    /// Bytes of its simplices, cells and walls, by estimate.
    pub bytes: usize,
}

/// Takes the cells of a sweep, in any order.
pub trait CellSink {
    /// Forgets all cells: they come again.
    fn clear(&mut self);

    /// Takes a cell, with the numbers of those of its neighbours that are known already. Cells are numbered
    /// from 0, in the order in which they come.
    fn cell(&mut self, number: u32, cell: Cell4) -> Result<()>;

    /// Takes another neighbour of the finite cell `number`, which came before; `first` is the first vertex of
    /// that cell.
    fn neighbour(&mut self, number: u32, first: u32, neighbour: u32) -> Result<()>;
}

/// A stage asks for at least one new point per so many that are left over. Smaller slabs would repeat too
/// much work.
const LEFT_PER_NEW: usize = 3;

/// Part of the room that a stage is to fill: one that turns out to be too large is begun again.
const LIKELY: f64 = 0.95;

/// Bytes of a wall of the stage before: in its lists, in their index, and as found again.
const WALL_BYTES: usize = 112;

/// Bytes per point of a full grid. Small integers that fit with so many are first tried in one stage.
const GRID_POINT_BYTES: usize = 1000;

/// Gives the cells of the diagram of sites to a sink.
///
/// # Errors
/// As those of [`super::diagram`]; memory, if neither the points of the least slab nor all points at once fit
/// the room; those of the sink.
pub(super) fn cells<C: Coefficient>(
    sites: &Sites,
    room: Room,
    threads: NonZeroUsize,
    sink: &mut impl CellSink,
    stats: &mut Stats,
) -> Result<()> {
    let mut sweep = Sweep { sites, threads, sink, stats, state: State::default() };
    let grid_bytes = GRID_POINT_BYTES.saturating_mul(sites.points.len());
    let may_be_grid = sites.exactness == Exactness::Small && grid_bytes <= room.bytes;
    if may_be_grid && sweep.at_once::<C>(room)? {
        return Ok(());
    }
    match sweep.stages::<C>(room) {
        Err(refused) if refused.kind() == ErrorKind::Memory && !may_be_grid => {
            // Points on the hull stay to the last stage, with walls and spurious cells: all points at once
            // may take less.
            sweep.sink.clear();
            sweep.state = State::default();
            if sweep.at_once::<C>(room)? { Ok(()) } else { Err(refused) }
        }
        done => done,
    }
}

/// What became of a stage.
enum Outcome {
    /// Its cells are in the sink. It took so many bytes, by estimate.
    Closed(usize),
    /// It would take more than it may. Nothing has changed.
    TooLarge,
}

struct Sweep<'a, S> {
    sites: &'a Sites,
    threads: NonZeroUsize,
    sink: &'a mut S,
    stats: &'a mut Stats,
    state: State,
}

impl<S: CellSink> Sweep<'_, S> {
    /// Gives all cells away in one stage. `false`, and none is given, if there is no room for it.
    fn at_once<C: Coefficient>(&mut self, room: Room) -> Result<bool> {
        let all: Vec<u32> = (0..self.sites.points.len() as u32).collect();
        let outcome = self.stage::<C>(&all, &[], room.bytes)?;
        Ok(matches!(outcome, Outcome::Closed(_)))
    }

    fn stages<C: Coefficient>(&mut self, mut room: Room) -> Result<()> {
        let mut slabs = Slabs::of(&self.sites.points);
        let mut points_per_byte = f64::INFINITY;
        loop {
            let left = &self.state.left;
            let bytes = room.bytes.saturating_sub(WALL_BYTES * self.state.walls.len());
            let points = room.points.min((points_per_byte * bytes as f64) as usize);
            let least = left.len() / LEFT_PER_NEW;
            let slab = slabs.next(points.saturating_sub(left.len()).max(least));
            let mut numbers = [left, slabs.numbers(slab)].concat();
            numbers.sort_unstable();
            let is_last = slabs.is_last(slab);
            match self.stage::<C>(&numbers, slabs.numbers_after(slab), bytes) {
                // The next stages are likely to take about as many bytes per point.
                Ok(Outcome::Closed(bytes)) => points_per_byte = LIKELY * numbers.len() as f64 / bytes as f64,
                // The points so far are in a hyperplane.
                Err(error) if error.kind() == ErrorKind::Usage && !is_last => self.state.left = numbers,
                Ok(Outcome::TooLarge) if slab == slabs.next(least) => {
                    return Err(too_small(numbers.len()));
                }
                Ok(Outcome::TooLarge) => {
                    room.points = room.points.min(numbers.len()) / 2;
                    continue;
                }
                Err(error) => return Err(error),
            }
            slabs.take(slab);
            if is_last {
                return Ok(());
            }
        }
    }

    /// Triangulates the points `numbers`, and gives the cells away that no point of `later` can change, in so
    /// many bytes.
    fn stage<C: Coefficient>(&mut self, numbers: &[u32], later: &[u32], bytes: usize) -> Result<Outcome> {
        let simplex = size_of::<Simplex>() + size_of::<Sphere<C>>();
        let complex = match triangulate_part::<C>(self.sites, numbers, bytes / simplex, self.stats) {
            Err(error) if error.kind() == ErrorKind::Io => return Ok(Outcome::TooLarge),
            complex => complex?,
        };
        let started = Instant::now();
        let created = simplex * complex.simplices.len();
        let closed = Rest::of(self.sites, later).closed(&complex);
        let Some(unordered) = merge::unordered(complex, &closed, bytes, self.threads, self.stats) else {
            return Ok(Outcome::TooLarge);
        };
        drop(closed);
        let taken = created.max(unordered.bytes);
        Stage::new(self.sites, unordered, later.is_empty()).close(&mut self.state, self.sink)?;
        self.stats.merge += started.elapsed();
        Ok(Outcome::Closed(taken))
    }
}

#[cold]
fn too_small(points: usize) -> Error {
    let message = format!(
        "not enough memory: {points} points that must be in memory at once have too many cells for it: give \
         more --memory, or none"
    );
    Error::new(ErrorKind::Memory, message)
}

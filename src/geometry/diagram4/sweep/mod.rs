//! Diagrams of many points in little memory, by a sweep along an axis.
//!
//! The points are cut into slabs. Each stage triangulates a slab and the points that the stages before left.
//! A finite cell that no point beyond the slab can change is *closed*: it is given to the caller and
//! forgotten. Points of other cells are left to the next stage; infinite cells are open until the last. A
//! *wall* is a facet between a closed cell and an open one. In the next stage, cells that are separated from
//! the open ones by walls fill the place of closed ones, and are *spurious*. Walls are facets of cells, whose
//! vertices do not depend on how cells are triangulated. docs/theory/four-dimensions.md proves that.

mod rest;
mod slabs;
mod stage;
mod walls;

use super::simplices::{Coefficient, triangulate_part};
use super::sites::Sites;
use super::{Stats, merge};
use rest::Rest;
use slabs::Slabs;
use spmesh_core::error::{Error, ErrorKind, Result};
use spmesh_model::cells4::Cell4;
use stage::{Stage, State};
use std::num::NonZeroUsize;
use std::time::Instant;

/// How much a stage of a sweep may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Room {
    /// Points of a stage, unless more are left over from the stage before.
    pub points: usize,
    /// Simplices and walls of a stage, infinite simplices included.
    pub simplices: usize,
}

/// Takes the cells of a sweep, in any order.
pub trait CellSink {
    /// Takes a cell, with the numbers of those of its neighbours that are known already. Cells are numbered
    /// from 0, in the order in which they come.
    ///
    /// # Errors
    /// Ends the sweep.
    fn cell(&mut self, number: u32, cell: Cell4) -> Result<()>;

    /// Takes another neighbour of the finite cell `number`, which came before; `first` is the first vertex of
    /// that cell.
    ///
    /// # Errors
    /// Ends the sweep.
    fn neighbour(&mut self, number: u32, first: u32, neighbour: u32) -> Result<()>;
}

/// A stage asks for at least one new point per so many that are left over. Smaller slabs would repeat too
/// much work.
const LEFT_PER_NEW: usize = 3;

/// Part of the room that a stage is to fill: one that turns out to be too large is begun again.
const LIKELY: f64 = 0.95;

/// Gives the cells of the diagram of sites to a sink.
///
/// # Errors
/// As those of [`super::diagram`]; memory, if the points of the least slab need more simplices than there is
/// room for; those of the sink.
pub(super) fn cells<C: Coefficient>(
    sites: &Sites,
    mut room: Room,
    threads: NonZeroUsize,
    sink: &mut impl CellSink,
    stats: &mut Stats,
) -> Result<()> {
    let mut slabs = Slabs::of(&sites.points);
    let (mut state, mut share) = (State::default(), f64::INFINITY);
    loop {
        let most = room.simplices.saturating_sub(state.walls.len());
        let points = room.points.min((share * most as f64) as usize);
        let least = state.left.len() / LEFT_PER_NEW;
        let slab = slabs.next(points.saturating_sub(state.left.len()).max(least));
        let mut numbers = [&state.left, slabs.numbers(slab)].concat();
        numbers.sort_unstable();
        let is_last = slabs.is_last(slab);
        let complex = match triangulate_part::<C>(sites, &numbers, most, stats) {
            Ok(complex) => complex,
            Err(error) if error.kind() == ErrorKind::Usage && !is_last => {
                // The points so far are in a hyperplane.
                state.left = numbers;
                slabs.take(slab);
                continue;
            }
            Err(error) if error.kind() == ErrorKind::Io => {
                if slab == slabs.next(least) {
                    return Err(too_small(most, numbers.len()));
                }
                room.points = room.points.min(numbers.len()) / 2;
                continue;
            }
            Err(error) => return Err(error),
        };
        // The next stages are likely to have about as many simplices of a point.
        share = LIKELY * numbers.len() as f64 / complex.simplices.len() as f64;
        let started = Instant::now();
        let closed = Rest::of(sites, slabs.numbers_after(slab)).closed(&complex);
        let unordered = merge::unordered(complex, &closed, threads, stats);
        drop((closed, numbers));
        Stage::new(sites, unordered, is_last).close(&mut state, sink)?;
        stats.merge += started.elapsed();
        slabs.take(slab);
        if is_last {
            return Ok(());
        }
    }
}

#[cold]
fn too_small(simplices: usize, points: usize) -> Error {
    let message = format!(
        "not enough memory: {points} points that must be in memory at once have more than {simplices} \
         simplices: give more --memory, or none"
    );
    Error::new(ErrorKind::Memory, message)
}

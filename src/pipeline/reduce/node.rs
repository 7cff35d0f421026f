//! One node of the reduction: triangulate, drop what lies in holes, split final from not final.

mod region;
mod written;

use super::bulk::{Bulk, Facet, WallSide};
use super::duplicates::Merged;
use super::misfit::{Misfit, overlap};
use super::patches::{Flush, PatchBuilder};
use super::residual::Residual;
use super::rules::Rules;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::PredicateCounts;
use spmesh_stream::PatchBlocks;
use spmesh_stream::model::bounds::Region;
use std::num::NonZeroUsize;

/// Simplices that are tested together.
const BATCH: usize = 128;

/// Simplices that a point has usually, at most.
const SIMPLICES_PER_POINT: usize = 16;

/// Stands for the index of a point that is not in the residual.
const NO_POINT: u32 = u32::MAX;

/// The bit of `wall_facets` for a hole beyond the facet opposite to corner 0.
const HOLE_BEYOND: u32 = 4;

/// State of a simplex of the node's triangulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum SimplexState {
    /// Final at this node: neither in a hole nor active.
    Open,
    /// In a hole: a node below has written a final simplex here.
    Hole,
    /// Not final: the node above triangulates it again.
    Active,
}

/// State of a point of the node, which decides when it is finalized.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum PointState {
    /// In final simplices only: finalized with the last of them.
    Interior,
    /// On the hull of all points: finalized here, even if it is in no final simplex of this node.
    Hull,
    /// In the residual.
    Residual,
    /// Merged with a point that it coincides with.
    Merged,
    /// In no simplex of all points, as its cell in the power diagram is empty: finalized here.
    Hidden,
}

/// Bytes of patches that points have usually, at most.
const PATCH_BYTES: usize = 256;

/// The result of a node.
#[derive(Debug, Default)]
pub(super) struct Solved<const D: usize> {
    /// Its final simplices.
    pub(super) blocks: PatchBlocks,
    /// The points and walls that the node above triangulates.
    pub(super) residual: Residual<D>,
    /// For each point of the residual that is not raw, the reference that stands for its id.
    pub(super) references: Vec<u64>,
    /// Points merged into others.
    pub(super) merged: Merged,
}

impl<const D: usize> Solved<D> {
    /// Whether there is anything to write. There is nothing if the points are passed up as they are.
    pub(super) fn has_patches(&self) -> bool {
        self.blocks.count() > 0
    }

    /// Bytes of its patches beyond what so many points usually have: points on curves have more.
    pub(super) fn bytes_beyond(&self, points: usize) -> usize {
        self.blocks.byte_len().saturating_sub(PATCH_BYTES * points)
    }
}

/// Triangulates one node after the other, in buffers that are used again.
pub(super) struct Solver<B, const D: usize> {
    rules: Rules<D>,
    bulk: B,
    simplex_states: Vec<SimplexState>,
    /// For each simplex the set of its facets (bit i: opposite to corner i) that are walls of its hole, and
    /// four bits higher of those on the hull beyond which lies a hole. Empty if there are no walls.
    wall_facets: Vec<u8>,
    stack: Vec<u32>,
    point_states: Vec<PointState>,
    /// Simplices that are not final.
    active: Vec<u32>,
    /// Walls of the residual, as facets of simplices that are not active.
    walls: Vec<Facet>,
    /// Walls of the residual on the hull, as facets of active simplices.
    outer_walls: Vec<Facet>,
    builder: PatchBuilder<D>,
    misfit: Option<Misfit>,
    /// Decisions of the predicates before [`Solver::forget`].
    earlier: PredicateCounts,
}

impl<B: Bulk<D>, const D: usize> Solver<B, D> {
    pub(super) fn new(rules: Rules<D>) -> Self {
        Solver {
            rules,
            bulk: B::default(),
            simplex_states: Vec::new(),
            wall_facets: Vec::new(),
            stack: Vec::new(),
            point_states: Vec::new(),
            active: Vec::new(),
            walls: Vec::new(),
            outer_walls: Vec::new(),
            builder: PatchBuilder::default(),
            misfit: None,
            earlier: PredicateCounts::default(),
        }
    }

    /// Gives the memory of the last node back to the system, if it was of so many points and more simplices
    /// than points usually have.
    pub(super) fn shrink(&mut self, points: usize) {
        if self.simplex_states.len() > SIMPLICES_PER_POINT * points + (1 << 16) {
            self.forget();
        }
    }

    /// Gives the memory of the last node back to the system.
    pub(super) fn forget(&mut self) {
        let earlier = self.counts();
        *self = Solver { earlier, ..Solver::new(self.rules) };
    }

    /// Triangulates the points of node `number`, and finds the simplices that are final in `region`, outside
    /// of which other points may lie. Nodes are numbered in the order in which they are written. The memory
    /// of `blocks` is used again. If there is `flush`, it may take patches as they come; the others are in
    /// the result.
    ///
    /// # Errors
    /// Those of `flush`; [`spmesh_base::error::ErrorKind::Malformed`] if coinciding points are forbidden or
    /// come from different nodes, or if the walls do not fit the points, which only damaged partial results
    /// can cause.
    pub(super) fn solve(
        &mut self,
        number: u64,
        points: &mut Residual<D>,
        region: &Region<D>,
        mut blocks: PatchBlocks,
        mut flush: Option<&mut Flush>,
    ) -> Result<Solved<D>> {
        blocks.clear();
        self.bulk.triangulate(points, self.rules.weights)?;
        let duplicates = self.bulk.duplicates();
        if let Some(pair) = duplicates.iter().find(|pair| pair.iter().any(|&i| i as usize >= points.raw)) {
            self.misfit = Some(Misfit::Points(*pair));
            return Err(overlap(points, pair[0], pair[1]));
        }
        let Rules { coordinates, weights, .. } = &self.rules;
        let merged = self.rules.duplicates.settle(points, duplicates, coordinates, *weights)?;
        self.find_holes(&points.walls)?;
        let everything = *region == Region::EVERYTHING && !self.rules.is_partial;
        self.builder.start(points.len(), self.rules.code, self.bulk.hidden().len(), flush.is_some());
        if everything && let Some(flush) = &mut flush {
            self.find_point_states(points, everything);
            let states = &self.simplex_states;
            let written = self.bulk.take_written(|simplex| states[simplex] == SimplexState::Open)?;
            if let Some(mut written) = written {
                self.write_all(&mut written, points, &mut blocks, flush)?;
                return Ok(Solved { blocks, merged, ..Solved::default() });
            }
        }
        self.bulk.arrange();
        let hidden = self.bulk.hidden().iter().copied();
        if !self.builder.is_planned() {
            self.builder.isolated(hidden, points, self.rules.code, &mut blocks, None)?;
        }
        self.split(points, region, everything, &mut blocks)?;
        self.find_point_states(points, everything);
        if let Some(flush) = &mut flush {
            self.write_planned(points, &mut blocks, flush)?;
        }
        self.write_rest(points, &mut blocks, flush)?;
        self.find_walls(points, everything);
        let (residual, references) = self.residual(number, points);
        Ok(Solved { blocks, residual, references, merged })
    }

    /// What does not fit, after [`Solver::solve`] failed.
    pub(super) fn misfit(&self) -> Option<Misfit> {
        self.misfit
    }

    /// Allows nodes so many bytes beyond those of each point.
    pub(super) fn allow(&mut self, bytes: u64) {
        self.bulk.allow(bytes);
    }

    /// Gives the next node so many threads.
    pub(super) fn share(&mut self, threads: NonZeroUsize) {
        self.bulk.share(threads);
    }

    /// Decisions of the predicates so far.
    pub(super) fn counts(&self) -> PredicateCounts {
        let mut counts = self.earlier;
        counts.merge(self.bulk.counts());
        counts
    }

    /// Finds the simplices in holes: a flood fill from the final sides of the walls that stops at walls.
    ///
    /// # Errors
    /// [`spmesh_base::error::ErrorKind::Malformed`] if a wall is not a facet, or the walls do not close a
    /// hole.
    fn find_holes(&mut self, walls: &[[u32; D]]) -> Result<()> {
        let (simplex_states, wall_facets, stack) =
            (&mut self.simplex_states, &mut self.wall_facets, &mut self.stack);
        simplex_states.clear();
        simplex_states.resize(self.bulk.len(), SimplexState::Open);
        wall_facets.clear();
        if walls.is_empty() || simplex_states.is_empty() {
            return Ok(());
        }
        wall_facets.resize(simplex_states.len(), 0);
        stack.clear();
        let searched = self.bulk.find(walls, |side| {
            let Facet { simplex, corner } = match side {
                WallSide::Final(facet) => facet,
                WallSide::Open(Facet { simplex, corner }) => {
                    wall_facets[simplex as usize] |= 1 << (HOLE_BEYOND + corner);
                    return;
                }
            };
            wall_facets[simplex as usize] |= 1 << corner;
            if simplex_states[simplex as usize] == SimplexState::Open {
                simplex_states[simplex as usize] = SimplexState::Hole;
                stack.push(simplex);
            }
        });
        if let Err(wall) = searched {
            self.misfit = Some(Misfit::Wall(wall));
            let (facet, triangulation) = (B::FACET, B::TRIANGULATION);
            let message = format!("a wall of a residual is no {facet} of the {triangulation}");
            return Err(Error::malformed(message));
        }
        while let Some(simplex) = stack.pop() {
            for corner in 0..=D as u32 {
                if wall_facets[simplex as usize] & 1 << corner != 0 {
                    continue;
                }
                let Some(neighbour) = self.bulk.neighbour(Facet { simplex, corner }) else {
                    // A hole may reach the hull only where infinite simplices were final.
                    if self.rules.sides.are_known() {
                        continue;
                    }
                    self.misfit = Some(Misfit::Point(self.bulk.corners(simplex).as_ref()[0]));
                    return Err(Error::malformed("the walls of a residual do not close a hole"));
                };
                let state = &mut simplex_states[neighbour.simplex as usize];
                if *state == SimplexState::Open {
                    *state = SimplexState::Hole;
                    stack.push(neighbour.simplex);
                }
            }
        }
        Ok(())
    }

    /// Splits the simplices outside of holes: final ones are planned for patches, or added to them if there
    /// is no plan; the others are active. If no other point exists, `everything` is final.
    fn split(
        &mut self,
        points: &Residual<D>,
        region: &Region<D>,
        everything: bool,
        blocks: &mut PatchBlocks,
    ) -> Result<()> {
        let balls = B::balls(&self.rules.coordinates, *region, self.rules.weights);
        let (bulk, builder, code) = (&self.bulk, &mut self.builder, self.rules.code);
        self.active.clear();
        let mut are_final = [false; BATCH];
        for first in (0..bulk.len()).step_by(BATCH) {
            let are_final = &mut are_final[..BATCH.min(bulk.len() - first)];
            for (k, is_final) in (first..).zip(&mut *are_final) {
                *is_final = self.simplex_states[bulk.nth(k) as usize] == SimplexState::Open;
            }
            if !everything {
                bulk.keep_inside(first, are_final, points, &balls);
            }
            for (k, &mut is_final) in (first..).zip(are_final) {
                let simplex = bulk.nth(k);
                let state = &mut self.simplex_states[simplex as usize];
                if is_final && builder.is_planned() {
                    builder.plan(bulk.corners(simplex).as_ref());
                } else if is_final {
                    if builder.add(bulk.written(simplex).as_ref()) {
                        builder.close(points, code, blocks)?;
                    }
                } else if *state == SimplexState::Open {
                    *state = SimplexState::Active;
                    self.active.push(simplex);
                }
            }
        }
        Ok(())
    }

    /// Whether the infinite simplex at a facet of the hull is one of all points of this node, and not final.
    /// In a hole, the facet is one only if it is a wall.
    fn is_open(&self, facet: Facet, points: &Residual<D>) -> bool {
        let is_hole = self.simplex_states[facet.simplex as usize] == SimplexState::Hole;
        if self.has_hole_beyond(facet) || (is_hole && !self.has_wall(facet, facet.corner)) {
            return false;
        }
        let corners = self.bulk.wall(facet);
        !self.rules.sides.hold(corners.iter().map(|&v| points.at[v as usize]))
    }

    /// Whether a facet of the hull is a wall with its final side outside.
    fn has_hole_beyond(&self, facet: Facet) -> bool {
        self.has_wall(facet, HOLE_BEYOND + facet.corner)
    }

    fn has_wall(&self, facet: Facet, bit: u32) -> bool {
        self.wall_facets.get(facet.simplex as usize).is_some_and(|walls| walls & 1 << bit != 0)
    }

    /// Finds the states of the points. If `everything` is final, so are the infinite simplices, and no
    /// simplex is active.
    fn find_point_states(&mut self, points: &Residual<D>, everything: bool) {
        let mut point_states = std::mem::take(&mut self.point_states);
        point_states.clear();
        point_states.resize(points.len(), PointState::Interior);
        let is_flat = self.bulk.len() == 0 && !self.rules.sides.coincide();
        let on_hull = if is_flat && !everything { PointState::Residual } else { PointState::Hull };
        self.bulk.hull_vertices().for_each(|v| point_states[v as usize] = on_hull);
        if !everything {
            for facet in self.bulk.hull_facets().filter(|&facet| self.is_open(facet, points)) {
                self.bulk.wall(facet).iter().for_each(|&v| point_states[v as usize] = PointState::Residual);
            }
        }
        let active = if everything { &[] } else { &self.active[..] };
        for &simplex in active {
            for &v in self.bulk.corners(simplex).as_ref() {
                point_states[v as usize] = PointState::Residual;
            }
        }
        self.bulk
            .duplicates()
            .iter()
            .for_each(|&[point, _]| point_states[point as usize] = PointState::Merged);
        self.bulk.hidden().iter().for_each(|&point| point_states[point as usize] = PointState::Hidden);
        self.point_states = point_states;
    }

    /// Finds the walls: facets between a simplex that is not active and an active or infinite one.
    fn find_walls(&mut self, points: &Residual<D>, everything: bool) {
        let (mut walls, mut outer_walls) =
            (std::mem::take(&mut self.walls), std::mem::take(&mut self.outer_walls));
        let is_done = |facet: &Facet| self.simplex_states[facet.simplex as usize] != SimplexState::Active;
        walls.clear();
        outer_walls.clear();
        for &simplex in &self.active {
            let neighbours =
                (0..=D as u32).filter_map(|corner| self.bulk.neighbour(Facet { simplex, corner }));
            walls.extend(neighbours.filter(is_done));
        }
        if !everything {
            for facet in self.bulk.hull_facets() {
                match is_done(&facet) {
                    true if self.is_open(facet, points) => walls.push(facet),
                    false if self.has_hole_beyond(facet) => outer_walls.push(facet),
                    _ => {}
                }
            }
        }
        walls.sort_unstable();
        (self.walls, self.outer_walls) = (walls, outer_walls);
    }

    /// The residual, with references for the ids of its points.
    fn residual(&mut self, number: u64, points: &Residual<D>) -> (Residual<D>, Vec<u64>) {
        let count = self.point_states.iter().filter(|&&state| state == PointState::Residual).count();
        let mut residual = Residual::with_capacity(count, self.walls.len());
        let mut references = Vec::with_capacity(count);
        let mut index_above = vec![NO_POINT; if count == 0 { 0 } else { points.len() }];
        for (v, _) in (0..).zip(&self.point_states).filter(|&(_, &state)| state == PointState::Residual) {
            let reference = self.builder.reference(v, points);
            index_above[v as usize] = residual.len() as u32;
            let key = self.builder.key(v, number, points);
            residual.push(points.point(v as usize), points.row(v as usize), key);
            references.push(reference);
        }
        let above = |v: u32| index_above[v as usize];
        if self.bulk.len() == 0 && count > 0 {
            residual.walls.extend(points.walls.iter().map(|wall| wall.map(above)));
        }
        residual.walls.extend(self.walls.iter().map(|&facet| self.bulk.wall(facet).map(above)));
        residual.walls.extend(self.outer_walls.iter().map(|&facet| {
            let mut wall = self.bulk.wall(facet).map(above);
            wall.swap(0, 1);
            wall
        }));
        residual.active = self.active.len();
        residual.left = count;
        (residual, references)
    }
}

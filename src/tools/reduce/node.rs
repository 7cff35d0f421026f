//! One node of the reduction: triangulate, drop what lies in holes, split final from not final.

use super::bulk::{Bulk, Facet};
use super::duplicates::Duplicates;
use super::patches::{Flush, PatchBuilder};
use super::residual::Residual;
use spmesh_core::error::{Error, Result};
use spmesh_geometry::predicates::PredicateCounts;
use spmesh_model::bounds::Region;
use spmesh_stream::{Coordinates, Header, PatchBlocks, PointCode};

/// What every node of one run has in common.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rules {
    coordinates: Coordinates,
    code: PointCode,
    duplicates: Duplicates,
    /// Whether the run leaves a residual, to be merged with others.
    pub(super) is_partial: bool,
    /// Whether nodes are triangulated that would leave most of their points.
    pub(super) every_node: bool,
}

impl Rules {
    /// The rules for a mesh with the given header.
    pub(super) fn new(header: &Header, duplicates: Duplicates, is_partial: bool) -> Self {
        let code = PointCode::of(header);
        Rules { coordinates: header.coordinates, code, duplicates, is_partial, every_node: false }
    }

    /// How coordinates are stored, which tells what numbers they are.
    pub(super) fn coordinates(&self) -> &Coordinates {
        &self.coordinates
    }
}

/// No number of a point of the residual.
const NONE: u32 = u32::MAX;

/// What became of a simplex of a node's triangulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Fate {
    /// Not in a hole, and not found active: final.
    Open,
    /// In a hole: a final simplex stands there already, written at a node below.
    Hole,
    /// Not final: triangulated again above.
    Active,
}

/// What is known of a point of a node beside the simplices that it is in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mark {
    /// Nothing: it is done with its last final simplex.
    None,
    /// On the hull, where there are no points beyond: done, and maybe in no final simplex of this node.
    Hull,
    /// Belongs to the residual.
    Residual,
    /// Coincides with another point and is no vertex.
    Merged,
}

/// What a node leaves.
#[derive(Debug, Default)]
pub(super) struct Solved<const D: usize> {
    /// Its final simplices.
    pub(super) blocks: PatchBlocks,
    /// What the node above has to triangulate.
    pub(super) residual: Residual<D>,
    /// For each point of the residual that is not raw, the reference that stands for its id.
    pub(super) references: Vec<u64>,
    /// Number of points merged into others.
    pub(super) merged: u64,
}

impl<const D: usize> Solved<D> {
    /// Whether there is anything to be written: not where points are passed up as they are.
    pub(super) fn has_patches(&self) -> bool {
        self.blocks.count() > 0
    }
}

/// Triangulates nodes, one after the other, in buffers that are used again.
pub(super) struct Solver<B, const D: usize> {
    rules: Rules,
    bulk: B,
    fates: Vec<Fate>,
    /// For each simplex the set of its facets (bit i: opposite to corner i) that are walls of its hole.
    wall_facets: Vec<u8>,
    stack: Vec<u32>,
    marks: Vec<Mark>,
    /// Simplices that are not final.
    active: Vec<u32>,
    /// Walls of the residual, as facets of simplices that are done.
    walls: Vec<Facet>,
    builder: PatchBuilder<D>,
}

impl<B: Bulk<D>, const D: usize> Solver<B, D> {
    pub(super) fn new(rules: Rules) -> Self {
        Solver {
            rules,
            bulk: B::default(),
            fates: Vec::new(),
            wall_facets: Vec::new(),
            stack: Vec::new(),
            marks: Vec::new(),
            active: Vec::new(),
            walls: Vec::new(),
            builder: PatchBuilder::default(),
        }
    }

    /// Triangulates the points of node `number`, and finds what is final in `region`, outside of which other points
    /// may lie. Nodes are numbered in the order in which they are written. The memory of `blocks` is used again;
    /// `flush` may take patches as they come, and what it leaves is in the result.
    ///
    /// # Errors
    /// What `flush` fails with;
    /// [`spmesh_core::error::ErrorKind::Malformed`] if coinciding points are forbidden or come from different
    /// nodes, or the walls do not fit the points, which only damaged partial results can bring about.
    pub(super) fn solve(
        &mut self,
        number: u64,
        points: &mut Residual<D>,
        region: &Region<D>,
        mut blocks: PatchBlocks,
        flush: &mut Flush,
    ) -> Result<Solved<D>> {
        blocks.clear();
        self.bulk.triangulate(points)?;
        let duplicates = self.bulk.duplicates();
        if let Some(pair) = duplicates.iter().find(|pair| pair.iter().any(|&i| i as usize >= points.raw)) {
            return Err(overlap(points, pair[0], pair[1]));
        }
        self.rules.duplicates.settle(points, duplicates, &self.rules.coordinates)?;
        self.find_holes(&points.walls)?;
        let everything = *region == Region::EVERYTHING && !self.rules.is_partial;
        self.split(points, region, everything);
        self.mark_points(points.len(), everything);
        self.write_patches(points, &mut blocks, flush)?;
        self.find_walls(everything);
        let (residual, references) = self.residual(number, points);
        let merged = self.bulk.duplicates().len() as u64;
        Ok(Solved { blocks, residual, references, merged })
    }

    /// Decisions of the predicates so far.
    pub(super) fn counts(&self) -> &PredicateCounts {
        self.bulk.counts()
    }

    /// Marks the simplices in holes: floods from the final sides of the walls, and stops at walls.
    fn find_holes(&mut self, walls: &[[u32; D]]) -> Result<()> {
        let (fates, wall_facets, stack) = (&mut self.fates, &mut self.wall_facets, &mut self.stack);
        fates.clear();
        fates.resize(self.bulk.len(), Fate::Open);
        if walls.is_empty() {
            return Ok(());
        }
        wall_facets.clear();
        wall_facets.resize(fates.len(), 0);
        stack.clear();
        self.bulk.find(walls, |Facet { simplex, corner }| {
            wall_facets[simplex as usize] |= 1 << corner;
            if fates[simplex as usize] == Fate::Open {
                fates[simplex as usize] = Fate::Hole;
                stack.push(simplex);
            }
        })?;
        while let Some(simplex) = stack.pop() {
            for corner in 0..=D as u32 {
                if wall_facets[simplex as usize] & 1 << corner != 0 {
                    continue;
                }
                let Some(beyond) = self.bulk.across(Facet { simplex, corner }) else {
                    return Err(Error::malformed("the walls of a residual do not close a hole"));
                };
                let fate = &mut fates[beyond.simplex as usize];
                if *fate == Fate::Open {
                    *fate = Fate::Hole;
                    stack.push(beyond.simplex);
                }
            }
        }
        Ok(())
    }

    /// Decides the simplices that are not in holes: final ones are planned for patches, the others are active. Where no
    /// other point exists, `everything` is final.
    fn split(&mut self, points: &Residual<D>, region: &Region<D>, everything: bool) {
        let balls = B::balls(&self.rules.coordinates, *region);
        self.builder.start(points.len());
        self.active.clear();
        for simplex in (0..self.fates.len()).map(|k| self.bulk.nth(k)) {
            let fate = &mut self.fates[simplex as usize];
            if *fate == Fate::Hole {
                continue;
            }
            if everything || self.bulk.is_inside(simplex, points, &balls) {
                self.builder.plan(self.bulk.corners(simplex).as_ref());
            } else {
                *fate = Fate::Active;
                self.active.push(simplex);
            }
        }
    }

    /// Finds out what becomes of the points. If `everything` is final, the infinite simplices are, too.
    fn mark_points(&mut self, points: usize, everything: bool) {
        let marks = &mut self.marks;
        marks.clear();
        marks.resize(points, Mark::None);
        let on_hull = if everything { Mark::Hull } else { Mark::Residual };
        self.bulk.hull_vertices().for_each(|v| marks[v as usize] = on_hull);
        for &simplex in &self.active {
            for &v in self.bulk.corners(simplex).as_ref() {
                marks[v as usize] = Mark::Residual;
            }
        }
        self.bulk.duplicates().iter().for_each(|&[point, _]| marks[point as usize] = Mark::Merged);
    }

    /// Writes the final simplices, and the points that are done but in none of them: vertices of the hull whose simplices
    /// were all written below, and at the root the points of an input without simplices.
    ///
    /// # Errors
    /// If a point has no simplex outside of the holes: no node leaves such a point.
    fn write_patches(
        &mut self,
        points: &Residual<D>,
        blocks: &mut PatchBlocks,
        flush: &mut Flush,
    ) -> Result<()> {
        let (builder, code) = (&mut self.builder, self.rules.code);
        let mut unused = Vec::new();
        for (v, &mark) in (0..).zip(&self.marks) {
            match mark {
                Mark::Hull if builder.is_unused(v) => unused.push(v),
                Mark::None if builder.is_unused(v) => {
                    let point = points.point(v as usize);
                    return Err(Error::malformed(format!(
                        "residual point {point:?} lies inside of a final {}",
                        B::SIMPLEX
                    )));
                }
                Mark::Residual => builder.keep(v),
                _ => {}
            }
        }
        for simplex in (0..self.fates.len()).map(|k| self.bulk.nth(k)) {
            if self.fates[simplex as usize] == Fate::Open {
                builder.simplex(self.bulk.corners(simplex).as_ref(), points, code, blocks, flush)?;
            }
        }
        builder.finish(unused.into_iter(), points, code, blocks, flush)
    }

    /// Finds the facets of simplices that are done beyond which there is one that is not, finite or infinite.
    fn find_walls(&mut self, everything: bool) {
        let is_done = |facet: &Facet| self.fates[facet.simplex as usize] != Fate::Active;
        self.walls.clear();
        for &simplex in &self.active {
            let beyond = (0..=D as u32).filter_map(|corner| self.bulk.across(Facet { simplex, corner }));
            self.walls.extend(beyond.filter(is_done));
        }
        if !everything {
            self.walls.extend(self.bulk.hull_facets().filter(is_done));
        }
        self.walls.sort_unstable();
    }

    /// The residual, with references for the ids of its points.
    fn residual(&mut self, number: u64, points: &Residual<D>) -> (Residual<D>, Vec<u64>) {
        let count = self.marks.iter().filter(|&&mark| mark == Mark::Residual).count();
        let mut residual = Residual::with_capacity(count, self.walls.len());
        let mut references = Vec::with_capacity(count);
        let mut index_above = vec![NONE; if count == 0 { 0 } else { points.len() }];
        for (v, _) in (0..).zip(&self.marks).filter(|&(_, &mark)| mark == Mark::Residual) {
            let reference = self.builder.reference(v, points);
            index_above[v as usize] = residual.len() as u32;
            residual.push(points.point(v as usize), self.builder.key(v, number, points));
            references.push(reference);
        }
        let above = |v: u32| index_above[v as usize];
        residual.walls.extend(self.walls.iter().map(|&facet| self.bulk.wall(facet).map(above)));
        residual.active = self.active.len();
        (residual, references)
    }
}

fn overlap<const D: usize>(points: &Residual<D>, point: u32, vertex: u32) -> Error {
    let [a, b] = [point, vertex].map(|i| points.point(i as usize));
    Error::malformed(format!(
        "point {a:?} coincides with {b:?} of another cell or tile (stored coordinates): regions overlap"
    ))
}

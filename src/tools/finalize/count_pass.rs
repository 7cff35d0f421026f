//! Passes 1 and 2: where the points are, and how many in which cell.

use super::count::{CellSums, Counters};
use super::work::Work;
use super::{Leaves, Options, Pass, Passes, depth_max};
use crate::cell_grid::CellGrid;
use spmesh_core::error::{Error, Result};
use spmesh_model::bounds::{Bounds, Point};
use spmesh_model::cells::{CellCode, CellTree};
use spmesh_stream::Coordinates;

/// A cell of the finest counted level is counted again, finer, if it holds more than this many times the
/// points that a leaf should hold.
const CROWDED: u64 = 4;

/// Grids of counts, each finer than the one before: the first of all points, the others of crowded cells.
const GRIDS_MAX: usize = 4;

/// What the first passes found.
pub(super) struct Survey {
    /// Exact bounding box; `None` without points.
    pub(super) bounds: Option<Bounds>,
    /// Number of points.
    pub(super) points: u64,
    /// Counts per cell; `None` without points, and where no cube around them is finite.
    pub(super) grid: Option<Grid>,
}

/// Counts per cell of a tree, finer where many points are.
pub(super) struct Grid {
    /// Tree of the deepest level that leaves may have.
    pub(super) tree: CellTree,
    sums: Vec<CellSums>,
    crowded: u64,
}

impl Grid {
    /// Number of points in `cell`, and whether the cells one level down are known too. The parents of `cell`
    /// must be known in this sense.
    pub(super) fn count(&self, cell: CellCode) -> (u64, bool) {
        let level = self.tree.level(cell);
        let at = self.sums.partition_point(|sums| sums.level() < level);
        let count = self.sums[at].count(cell);
        let is_finer_known =
            level < self.sums[at].level() || (count > self.crowded && at + 1 < self.sums.len());
        (count, is_finer_known)
    }

    fn finest(&self) -> &CellSums {
        self.sums.last().expect("a grid has counts")
    }

    /// Sets the codes of points that lie in no crowded cell to 0; `deepest` are cells of the deepest level.
    fn keep_crowded(&self, deepest: &mut [CellCode]) {
        let shift = self.tree.dims() * (self.tree.depth() - self.finest().level());
        let mut last = (CellCode(0), false);
        for code in deepest {
            let cell = CellCode(code.0 >> shift);
            if cell != last.0 {
                last = (cell, self.finest().count(cell) > self.crowded);
            }
            if !last.1 {
                *code = CellCode(0);
            }
        }
    }
}

/// A batch of points as passes 1 and 2 need it.
#[derive(Default)]
struct Surveyed {
    /// Cells of the deepest level; 0 for points outside of the tree.
    cells: Vec<CellCode>,
    outside: u64,
    bounds: Option<Bounds>,
}

impl Surveyed {
    fn prepare(&mut self, tree: &CellTree, points: &[Point]) {
        self.bounds = bounds_of(points);
        self.cells.clear();
        match CellGrid::new(tree, tree.depth()) {
            Some(grid) => self.cells.extend(points.iter().map(|&point| grid.cell_of(point))),
            None => self.cells.extend(points.iter().map(|&point| match tree.contains(point) {
                true => tree.cell_of(point, tree.depth()),
                false => CellCode(0),
            })),
        }
        // Most batches lie inside as a whole, and the corners of their box tell.
        self.outside = 0;
        if !self.bounds.is_some_and(|bounds| tree.contains(bounds.min) && tree.contains(bounds.max)) {
            for (cell, &point) in self.cells.iter_mut().zip(points) {
                if !tree.contains(point) {
                    *cell = CellCode(0);
                    self.outside += 1;
                }
            }
        }
    }
}

/// Result of a counting pass over a tree that may not hold all points.
struct Count {
    bounds: Option<Bounds>,
    points: u64,
    outside: u64,
    sums: CellSums,
}

impl<P: Passes + ?Sized> Work<'_, P> {
    /// Finds bounding box and counts per cell.
    ///
    /// A box that the headers state saves pass 1. It is verified while counting, and where it proves wrong,
    /// counting starts again with the true one.
    pub(super) fn survey(&mut self, options: &Options) -> Result<Survey> {
        let stated = self.input.description().stated_bounds;
        let (bounds, points) = match stated.and_then(|stated| self.tree(&stated, options.leaves)) {
            Some(tree) => {
                let count = self.count(tree, options)?;
                if self.can_use(&count, stated, &tree, options.leaves) {
                    return self.finish_survey(tree, count, options);
                }
                (count.bounds, count.points)
            }
            None => self.bounding_box()?,
        };
        let Some(tree) = bounds.and_then(|bounds| self.tree(&bounds, options.leaves)) else {
            if bounds.is_some() {
                self.observer
                    .notice("the extent of the points is too large for a finalization tree: no tags");
            }
            self.stats.points = points;
            return Ok(Survey { bounds, points, grid: None });
        };
        let count = self.count(tree, options)?;
        if count.outside > 0 || count.bounds != bounds || count.points != points {
            return Err(input_changed());
        }
        // Of a border at zero that one pass has as -0 and another, from a spool, as 0, the first one counts.
        self.finish_survey(tree, Count { bounds, ..count }, options)
    }

    /// Whether a count over the cube of the stated box can stand.
    fn can_use(&mut self, count: &Count, stated: Option<Bounds>, tree: &CellTree, leaves: Leaves) -> bool {
        let (Some(stated), Some(bounds)) = (stated, count.bounds) else {
            return count.outside == 0;
        };
        if stated.union(bounds) != stated {
            self.observer
                .notice("the bounding box in the input's header leaves points out: using the true one");
        }
        // On a fixed level a box that is much too large would leave most cells empty.
        let is_tight = match leaves {
            Leaves::Collapsed { .. } => true,
            Leaves::Level(_) => self.tree(&bounds, leaves).is_some_and(|exact| exact.side() == tree.side()),
        };
        count.outside == 0 && is_tight
    }

    fn finish_survey(&mut self, tree: CellTree, count: Count, options: &Options) -> Result<Survey> {
        let Count { bounds, points, sums, .. } = count;
        self.stats.points = points;
        if bounds.is_none() {
            return Ok(Survey { bounds, points, grid: None });
        }
        let mut grid = Grid { tree, sums: vec![sums], crowded: u64::MAX };
        if let Leaves::Collapsed { cell_points, .. } = options.leaves {
            grid.crowded = cell_points.saturating_mul(CROWDED);
            self.refine(&mut grid, options)?;
        }
        Ok(Survey { bounds, points, grid: Some(grid) })
    }

    /// Pass 1: the exact bounding box and the number of points.
    fn bounding_box(&mut self) -> Result<(Option<Bounds>, u64)> {
        let (mut bounds, mut points) = (None, 0);
        let prepare = |batch: &[Point], found: &mut Option<Bounds>| {
            *found = bounds_of(batch);
            Ok(())
        };
        self.read_all(Pass::Bounds, prepare, |batch, found| {
            points += batch.len() as u64;
            bounds = union(bounds, *found);
            Ok(())
        })?;
        Ok((bounds, points))
    }

    /// Pass 2: counts per cell.
    fn count(&mut self, tree: CellTree, options: &Options) -> Result<Count> {
        let mut counters = match options.leaves {
            Leaves::Level(_) => Counters::fixed(tree, tree.depth(), options.budget.counters_of_fixed_level()),
            Leaves::Collapsed { .. } => Counters::adaptive(tree, tree.depth(), options.budget.counters()),
        };
        let (mut bounds, mut points, mut outside) = (None, 0, 0);
        let prepare = |batch: &[Point], surveyed: &mut Surveyed| {
            surveyed.prepare(&tree, batch);
            Ok(())
        };
        self.read_all(Pass::Count, prepare, |batch, surveyed| {
            points += batch.len() as u64;
            bounds = union(bounds, surveyed.bounds);
            outside += surveyed.outside;
            counters.add(&surveyed.cells)
        })?;
        Ok(Count { bounds, points, outside, sums: counters.into_sums() })
    }

    /// Counts crowded cells again on finer grids, until none is left or finer grids do not fit either.
    fn refine(&mut self, grid: &mut Grid, options: &Options) -> Result<()> {
        while grid.sums.len() < GRIDS_MAX
            && grid.finest().level() < grid.tree.depth()
            && grid.finest().has_more_than(grid.crowded)
        {
            let mut counters = Counters::adaptive(grid.tree, grid.tree.depth(), options.budget.counters());
            let known = &*grid;
            let prepare = |batch: &[Point], surveyed: &mut Surveyed| {
                surveyed.prepare(&known.tree, batch);
                if surveyed.outside > 0 {
                    return Err(input_changed());
                }
                known.keep_crowded(&mut surveyed.cells);
                Ok(())
            };
            self.read_all(Pass::Refine, prepare, |_, surveyed| counters.add(&surveyed.cells))?;
            if counters.level() <= grid.finest().level() {
                break;
            }
            grid.sums.push(counters.into_sums());
        }
        Ok(())
    }

    /// The tree around `bounds`, as deep as leaves may be.
    fn tree(&self, bounds: &Bounds, leaves: Leaves) -> Option<CellTree> {
        let description = self.input.description();
        let depth_max = depth_max(description.dims);
        let cube = CellTree::covering(bounds, description.dims, 0)?;
        let depth = match leaves {
            Leaves::Level(level) => level.min(depth_max),
            Leaves::Collapsed { level_max, .. } => {
                // Cells that are smaller than the step between integer coordinates divide nothing.
                let useful = match description.coordinates {
                    Coordinates::I32 { .. } => cube.side().log2().max(0.0) as u8,
                    Coordinates::F64 => depth_max,
                };
                useful.min(depth_max).min(level_max.unwrap_or(depth_max))
            }
        };
        CellTree::new(description.dims, depth, cube.origin(), cube.side())
    }
}

/// The box of all `points`, which are finite; a loop without the branches that others need for NaN.
fn bounds_of(points: &[Point]) -> Option<Bounds> {
    let Bounds { mut min, mut max } = Bounds::of_point(*points.first()?);
    for point in points {
        for ((min, max), &value) in min.iter_mut().zip(&mut max).zip(point) {
            *min = if value < *min { value } else { *min };
            *max = if value > *max { value } else { *max };
        }
    }
    Some(Bounds { min, max })
}

/// The box that holds both.
fn union(one: Option<Bounds>, other: Option<Bounds>) -> Option<Bounds> {
    match (one, other) {
        (Some(one), Some(other)) => Some(one.union(other)),
        (one, other) => one.or(other),
    }
}

/// The input is not the same in every pass.
pub(super) fn input_changed() -> Error {
    Error::malformed("the input changed between two passes over it")
}

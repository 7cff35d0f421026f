//! Passes 1 and 2: the bounding box, and the number of points per cell.

use super::batch::PointBatch;
use super::cell_grid::CellGrid;
use super::counters::{CellCounts, CellSums, Counters};
use super::options::{Leaves, Options, depth_max};
use super::passes::Pass;
use super::passes::input_changed;
use super::work::Work;
use crate::regions::Sample;
use spmesh_base::error::Result;
use spmesh_formats::source::FillValues;
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::model::cells::{CellCode, CellTree};

/// A cell of the finest counted level is crowded, and counted again on a finer grid, if it holds more than
/// this many times the points that a leaf should hold.
const CROWDED: u64 = 4;

/// Most grids of counts.
const GRIDS_MAX: usize = 4;

/// The result of passes 1 and 2.
pub(super) struct PointCounts {
    /// Exact bounding box; `None` without points.
    pub(super) bounds: Option<Bounds>,
    /// Number of points.
    pub(super) points: u64,
    /// Counts per cell; `None` without points, and if no cube around them is finite.
    pub(super) cells: Option<CellCounts>,
}

/// The cells and the bounding box of a batch.
#[derive(Default)]
struct BatchCells {
    /// Cells of the deepest level; 0 for points outside of the tree.
    cells: Vec<CellCode>,
    outside: u64,
    bounds: Option<Bounds>,
}

impl BatchCells {
    fn prepare(&mut self, tree: &CellTree, points: &[Point]) {
        self.bounds = bounds_of(points);
        match CellGrid::new(tree, tree.depth()) {
            Some(grid) => grid.find_cells(points, &mut self.cells),
            None => {
                self.cells.clear();
                self.cells.extend(points.iter().map(|&point| match tree.contains(point) {
                    true => tree.cell_of(point, tree.depth()),
                    false => CellCode(0),
                }));
            }
        }
        // Most batches lie inside as a whole, which the corners of their box prove.
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
    fill_values: FillValues,
}

impl Work<'_> {
    /// Finds the bounding box and the counts per cell.
    ///
    /// A box stated by the headers saves pass 1. Pass 2 verifies it, and starts again with the true box if
    /// the stated one is wrong.
    ///
    /// # Errors
    /// Those of the input; [`spmesh_base::error::ErrorKind::Malformed`] if it changes between passes;
    /// [`spmesh_base::error::ErrorKind::Memory`] if the counters of a fixed level do not fit.
    pub(super) fn count_points(&mut self, options: &Options) -> Result<PointCounts> {
        let stated = self.input.description().stated_bounds;
        let (bounds, points) = match stated.and_then(|stated| self.tree(&stated, options.leaves)) {
            Some(tree) => {
                let count = self.count(tree, options)?;
                if self.can_use(&count, stated, &tree, options.leaves) {
                    return self.finish_count(tree, count, options);
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
            return Ok(PointCounts { bounds, points, cells: None });
        };
        let count = self.count(tree, options)?;
        if count.outside > 0 || count.bounds != bounds || count.points != points {
            return Err(input_changed());
        }
        // A side of the box may be -0 in the first pass and 0 in a later one that reads a spool: keep the
        // first box.
        self.finish_count(tree, Count { bounds, ..count }, options)
    }

    /// Whether the counts over the cube of the stated box are valid.
    fn can_use(&mut self, count: &Count, stated: Option<Bounds>, tree: &CellTree, leaves: Leaves) -> bool {
        let (Some(stated), Some(bounds)) = (stated, count.bounds) else {
            return count.outside == 0;
        };
        if stated.union(bounds) != stated {
            self.observer
                .notice("the bounding box in the input's header leaves points out: using the true one");
        }
        // On a fixed level, most cells of a box that is much too large would be empty.
        let is_tight = match leaves {
            Leaves::Collapsed { .. } => true,
            Leaves::Level(_) => self.tree(&bounds, leaves).is_some_and(|exact| exact.side() == tree.side()),
        };
        count.outside == 0 && is_tight
    }

    fn finish_count(&mut self, tree: CellTree, count: Count, options: &Options) -> Result<PointCounts> {
        let Count { bounds, points, sums, fill_values, .. } = count;
        self.stats.points = points;
        if !fill_values.is_empty() {
            self.observer.notice(&fill_values.to_string());
        }
        if bounds.is_none() {
            return Ok(PointCounts { bounds, points, cells: None });
        }
        let mut counts = CellCounts { tree, sums: vec![sums], crowded: u64::MAX };
        if let Leaves::Collapsed { cell_points, .. } = options.leaves {
            counts.crowded = cell_points.saturating_mul(CROWDED);
            self.refine(&mut counts, options)?;
        }
        Ok(PointCounts { bounds, points, cells: Some(counts) })
    }

    /// Pass 1: the exact bounding box and the number of points.
    fn bounding_box(&mut self) -> Result<(Option<Bounds>, u64)> {
        let (mut bounds, mut points) = (None, 0);
        let prepare = |batch: &PointBatch, found: &mut Option<Bounds>| {
            *found = bounds_of(&batch.points);
            Ok(())
        };
        self.read_all(Pass::Bounds, prepare, |batch, found| {
            points += batch.points.len() as u64;
            bounds = union(bounds, *found);
            Ok(())
        })?;
        Ok((bounds, points))
    }

    /// Pass 2: counts per cell.
    ///
    /// # Errors
    /// Those of the input; [`spmesh_base::error::ErrorKind::Memory`] if the counters of a fixed level do not
    /// fit.
    fn count(&mut self, tree: CellTree, options: &Options) -> Result<Count> {
        let mut counters = match options.leaves {
            Leaves::Level(_) => Counters::fixed(tree, tree.depth(), options.budget.counters_of_fixed_level()),
            Leaves::Collapsed { .. } => Counters::adaptive(tree, tree.depth(), options.budget.counters()),
        };
        let (mut bounds, mut points, mut outside) = (None, 0, 0);
        let (coordinates, mut fill_values) = (self.input.description().coordinates, FillValues::default());
        let prepare = |batch: &PointBatch, found: &mut BatchCells| {
            found.prepare(&tree, &batch.points);
            Ok(())
        };
        // The points may have been counted before, in another tree.
        let mut sample = self.sample.take().map(Sample::again);
        self.read_all(Pass::Count, prepare, |batch, found| {
            if let Some(sample) = &mut sample {
                sample.add(&batch.points);
            }
            points += batch.points.len() as u64;
            bounds = union(bounds, found.bounds);
            outside += found.outside;
            if let Some(Bounds { min, max }) = found.bounds {
                let stored = batch.points.iter().map(|point| point[2]);
                fill_values.add_stored(&coordinates, [min[2], max[2]], stored);
            }
            counters.add(&found.cells)
        })?;
        self.sample = sample;
        Ok(Count { bounds, points, outside, sums: counters.into_sums(), fill_values })
    }

    /// Counts crowded cells again on finer grids, until no cell is crowded or a finer grid does not fit.
    fn refine(&mut self, counts: &mut CellCounts, options: &Options) -> Result<()> {
        while counts.sums.len() < GRIDS_MAX
            && counts.finest().level() < counts.tree.depth()
            && counts.finest().has_more_than(counts.crowded)
        {
            let mut counters =
                Counters::adaptive(counts.tree, counts.tree.depth(), options.budget.counters());
            let known = &*counts;
            let prepare = |batch: &PointBatch, found: &mut BatchCells| {
                found.prepare(&known.tree, &batch.points);
                if found.outside > 0 {
                    return Err(input_changed());
                }
                known.keep_crowded(&mut found.cells);
                Ok(())
            };
            self.read_all(Pass::Refine, prepare, |_, found| counters.add(&found.cells))?;
            if counters.level() <= counts.finest().level() {
                break;
            }
            counts.sums.push(counters.into_sums());
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
                // Cells smaller than the step of integer coordinates divide nothing.
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

/// The box of all `points`, which are finite: unlike `f64::min`, the loop needs no branch for NaN.
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

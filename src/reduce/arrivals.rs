//! Points on their way into cells: held until the tag of a cell says that it is complete.

use std::collections::BTreeMap;

use super::residual::Residual;
use crate::bounds::{Point, Region};
use crate::cells::{CellCode, CellTree};
use crate::error::{Error, Result};
use crate::stream::FinalizedCells;

/// Points whose cell is not final yet.
///
/// In a chunked stream these are the points since the last tag, all in the cell that is tagged next. In any
/// other stream, points of other cells go to a bucket of their deepest cell and wait there.
pub(super) struct Arrivals {
    tree: Option<CellTree>,
    finalized: Option<FinalizedCells>,
    /// Points outside are counted and dropped.
    region: Region,
    current: Vec<Point>,
    buckets: BTreeMap<u64, Vec<Point>>,
    in_buckets: usize,
    held_max: usize,
    accepted: u64,
    outside: u64,
}

impl Arrivals {
    pub(super) fn new(tree: Option<CellTree>, region: Region) -> Self {
        Arrivals {
            tree,
            finalized: tree.map(FinalizedCells::new),
            region,
            current: Vec::new(),
            buckets: BTreeMap::new(),
            in_buckets: 0,
            held_max: 0,
            accepted: 0,
            outside: 0,
        }
    }

    /// Points of the stream. Those outside of the region are dropped.
    ///
    /// # Errors
    /// If a point lies in a cell that is final, or outside of the tree.
    pub(super) fn points(&mut self, points: &[Point]) -> Result<()> {
        for &point in points {
            if let Some(finalized) = &mut self.finalized {
                finalized.check_point(point)?;
            }
            if self.region.contains(point) {
                self.current.push(point);
            } else {
                self.outside += 1;
            }
        }
        self.held_max = self.held_max.max(self.current.len() + self.in_buckets);
        Ok(())
    }

    /// The tag of `cell`: its points, in the order of the stream, and whether they are all of it, because no
    /// part of the cell was final before.
    ///
    /// # Errors
    /// If the cell is final already.
    pub(super) fn tag(&mut self, cell: CellCode) -> Result<(Residual, bool)> {
        let (Some(tree), Some(finalized)) = (self.tree, &mut self.finalized) else {
            return Err(Error::malformed("cell tag in a stream without a finalization tree"));
        };
        let is_whole = finalized.is_open_cell(cell);
        finalized.finalize(cell)?;
        let (min, max) = tree.corners(cell);
        let inside = Region { min: [min[0], min[1]], max: [max[0], max[1]] };
        if !self.current.iter().all(|&point| inside.contains(point)) {
            self.move_to_buckets(&tree);
        }
        let buckets: Vec<u64> = self.buckets.range(tree.deepest_range(cell)).map(|(&key, _)| key).collect();
        let mut points = Residual::with_capacity(self.current.len(), 0);
        for points_of_bucket in buckets.iter().filter_map(|key| self.buckets.remove(key)) {
            self.in_buckets -= points_of_bucket.len();
            points_of_bucket.into_iter().for_each(|point| points.push_raw(point));
        }
        self.current.drain(..).for_each(|point| points.push_raw(point));
        self.accepted += points.len() as u64;
        Ok((points, is_whole))
    }

    /// The points whose cells were never tagged.
    pub(super) fn rest(&mut self) -> Residual {
        let mut points = Residual::with_capacity(self.current.len() + self.in_buckets, 0);
        for point in std::mem::take(&mut self.buckets).into_values().flatten() {
            points.push_raw(point);
        }
        self.in_buckets = 0;
        self.current.drain(..).for_each(|point| points.push_raw(point));
        self.accepted += points.len() as u64;
        points
    }

    /// Points handed on so far.
    pub(super) fn accepted(&self) -> u64 {
        self.accepted
    }

    /// Points dropped because they lie outside of the region.
    pub(super) fn outside(&self) -> u64 {
        self.outside
    }

    /// Most points held at once.
    pub(super) fn held_max(&self) -> usize {
        self.held_max
    }

    fn move_to_buckets(&mut self, tree: &CellTree) {
        for point in self.current.drain(..) {
            self.buckets.entry(tree.cell_of(point, tree.depth()).0).or_default().push(point);
            self.in_buckets += 1;
        }
    }
}

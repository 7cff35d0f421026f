//! Points that wait for the tag of their cell.

use std::collections::BTreeMap;

use super::duplicates::Merged;
use super::merging::Merging;
use super::residual::Residual;
use spmesh_base::error::{Error, Result};
use spmesh_stream::FinalizedCells;
use spmesh_stream::model::bounds::{Bounds, Point, Region};
use spmesh_stream::model::cells::{CellCode, CellTree};

/// Points of one deepest cell, with their rows if there are attributes.
#[derive(Default)]
struct Bucket {
    points: Vec<Point>,
    rows: Vec<u8>,
}

/// Points whose cell is not final yet.
///
/// In a chunked stream these are the points since the last tag, all in the cell that is tagged next. In any
/// other stream, points of other cells go to a bucket of their deepest cell and wait there.
pub(super) struct CellBuffer<const D: usize> {
    tree: Option<CellTree>,
    finalized: Option<FinalizedCells>,
    /// Points outside of it are counted and dropped.
    region: Region<D>,
    current: Residual<D>,
    merging: Merging,
    /// A box that contains `current`.
    bounds: Option<Bounds>,
    buckets: BTreeMap<u64, Bucket>,
    in_buckets: usize,
    held_max: usize,
    accepted: u64,
    outside: u64,
    merged: Merged,
}

impl<const D: usize> CellBuffer<D> {
    pub(super) fn new(tree: Option<CellTree>, region: Region<D>, merging: Merging) -> Self {
        CellBuffer {
            tree,
            finalized: tree.map(FinalizedCells::new),
            region,
            current: Residual::default(),
            merging,
            bounds: None,
            buckets: BTreeMap::new(),
            in_buckets: 0,
            held_max: 0,
            accepted: 0,
            outside: 0,
            merged: Merged::default(),
        }
    }

    /// Takes points of the stream with their bounding box, and with their rows if there are attributes. Drops
    /// those outside of the region.
    pub(super) fn points(&mut self, points: &[Point], rows: &[u8], bounds: &Bounds) -> Result<()> {
        if let Some(finalized) = &mut self.finalized {
            finalized.check_points_in(points, bounds)?;
        }
        if self.region.contains(bounds.min) && self.region.contains(bounds.max) {
            self.current.extend_raw(points, rows);
        } else {
            let (before, row_len) = (self.current.len(), rows.len() / points.len());
            for (i, point) in points.iter().enumerate().filter(|&(_, &point)| self.region.contains(point)) {
                let row = &rows[i * row_len..][..row_len];
                self.current.extend_raw(std::slice::from_ref(point), row);
            }
            self.outside += (points.len() - (self.current.len() - before)) as u64;
        }
        self.bounds = Some(self.bounds.map_or(*bounds, |all| all.union(*bounds)));
        self.held_max = self.held_max.max(self.held());
        let merged = self.merging.merge(&mut self.current)?;
        self.accepted += merged.points;
        self.merged += merged;
        Ok(())
    }

    /// Takes the tag of `cell`. Returns the points of the cell, in the order of the stream, and whether they
    /// are all of its points: they are not if a part of the cell was final before. `fresh` is an empty
    /// residual whose memory is reused.
    pub(super) fn tag(&mut self, cell: CellCode, fresh: Residual<D>) -> Result<(Residual<D>, bool)> {
        let (Some(tree), Some(finalized)) = (self.tree, &mut self.finalized) else {
            return Err(Error::malformed("cell tag in a stream without a finalization tree"));
        };
        let is_whole = finalized.is_open_cell(cell);
        finalized.finalize(cell)?;
        let (min, max) = tree.corners(cell);
        let inside = Region::between(min, max);
        if !self.all_inside(&inside) {
            self.move_to_buckets(&tree);
        }
        let points = self.take(tree.deepest_range(cell), fresh);
        Ok((points, is_whole))
    }

    /// The points whose cells were never tagged.
    pub(super) fn rest(&mut self) -> Residual<D> {
        self.take(0..u64::MAX, Residual::default())
    }

    /// Points passed on so far.
    pub(super) fn accepted(&self) -> u64 {
        self.accepted
    }

    /// Points dropped because they lie outside of the region.
    pub(super) fn outside(&self) -> u64 {
        self.outside
    }

    /// Points merged with others that they coincide with.
    pub(super) fn merged(&self) -> Merged {
        self.merged
    }

    /// Points held now.
    pub(super) fn held(&self) -> usize {
        self.current.len() + self.in_buckets
    }

    /// Most points held at once.
    pub(super) fn held_max(&self) -> usize {
        self.held_max
    }

    fn all_inside(&self, cell: &Region<D>) -> bool {
        let contains = |bounds: Bounds| cell.contains(bounds.min) && cell.contains(bounds.max);
        self.bounds.is_none_or(contains)
            || (0..self.current.len()).all(|i| cell.contains(self.current.point(i)))
    }

    /// The points of the buckets in `range`, in the order of the range, followed by those in no bucket.
    fn take(&mut self, range: std::ops::Range<u64>, fresh: Residual<D>) -> Residual<D> {
        self.bounds = None;
        self.merging.restart();
        let current = std::mem::replace(&mut self.current, fresh);
        self.accepted += current.len() as u64;
        let keys: Vec<u64> = self.buckets.range(range).map(|(&key, _)| key).collect();
        if keys.is_empty() {
            return current;
        }
        let mut points = Residual::default();
        for bucket in keys.iter().filter_map(|key| self.buckets.remove(key)) {
            self.in_buckets -= bucket.points.len();
            self.accepted += bucket.points.len() as u64;
            points.extend_raw(&bucket.points, &bucket.rows);
        }
        points.append_raw(&current);
        points
    }

    fn move_to_buckets(&mut self, tree: &CellTree) {
        for i in 0..self.current.len() {
            let point = self.current.point(i);
            let bucket = self.buckets.entry(tree.cell_of(point, tree.depth()).0).or_default();
            bucket.points.push(point);
            bucket.rows.extend_from_slice(self.current.row(i));
        }
        self.in_buckets += self.current.len();
        self.current.clear();
        self.bounds = None;
    }
}

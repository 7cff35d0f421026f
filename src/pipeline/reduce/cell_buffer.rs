//! Points that wait for the tag of their cell.

use std::collections::BTreeMap;

use super::budget::Held;
use super::duplicates::Merged;
use super::merging::Merging;
use super::residual::Residual;
use spmesh_base::error::{Error, Result};
use spmesh_stream::FinalizedCells;
use spmesh_stream::model::bounds::{Bounds, Point, Region};
use spmesh_stream::model::cells::{CellCode, CellTree};

/// Bytes of a bucket beside its points: its entry, and what the allocator adds.
const BUCKET_BYTES: usize = 192;

/// Points of one deepest cell, with their rows if there are attributes.
#[derive(Default)]
struct Bucket {
    points: Vec<Point>,
    rows: Vec<u8>,
}

impl Bucket {
    fn push(&mut self, point: Point, row: &[u8]) {
        if self.points.len() == self.points.capacity() {
            // Doubling would leave up to half of the memory idle.
            let more = 1 + self.points.len() / 8;
            self.points.reserve_exact(more);
            self.rows.reserve_exact(more * row.len());
        }
        self.points.push(point);
        self.rows.extend_from_slice(row);
    }

    fn bytes(&self) -> usize {
        BUCKET_BYTES + self.points.capacity() * size_of::<Point>() + self.rows.capacity()
    }
}

/// A cell that has become final.
#[derive(Debug)]
pub(super) struct Tagged<const D: usize> {
    pub(super) cell: CellCode,
    /// Its points in the order of the stream, without those of parts that were final before.
    pub(super) points: Residual<D>,
    /// Whether no part of it was final before.
    pub(super) is_whole: bool,
    /// How many of the cells above it are final now, as all of their parts are.
    pub(super) completes: u8,
}

impl<const D: usize> Tagged<D> {
    /// Whether nothing follows from it.
    pub(super) fn is_nothing(&self) -> bool {
        self.points.is_empty() && self.is_whole && self.completes == 0
    }
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
    /// Bytes of all buckets.
    bytes: usize,
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
            bytes: 0,
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
        self.held_max = self.held_max.max(self.held().points);
        let merged = self.merging.merge(&mut self.current)?;
        self.accepted += merged.points;
        self.merged += merged;
        Ok(())
    }

    /// Takes the tag of `cell`. `fresh` gives an empty residual whose memory is reused.
    pub(super) fn tag(&mut self, cell: CellCode, fresh: impl FnOnce() -> Residual<D>) -> Result<Tagged<D>> {
        let (Some(tree), Some(finalized)) = (self.tree, &mut self.finalized) else {
            return Err(Error::malformed("cell tag in a stream without a finalization tree"));
        };
        let is_whole = finalized.is_open_cell(cell);
        finalized.finalize(cell)?;
        let above = std::iter::successors(tree.parent(cell), |&cell| tree.parent(cell));
        let completes = above.take_while(|&cell| finalized.is_final_cell(cell)).count() as u8;
        if !self.current.is_empty() {
            let (min, max) = tree.corners(cell);
            if !self.all_inside(&Region::between(min, max)) {
                self.move_to_buckets(&tree);
            }
        }
        let points = self.take(tree.deepest_range(cell), fresh);
        Ok(Tagged { cell, points, is_whole, completes })
    }

    /// The points whose cells were never tagged.
    pub(super) fn rest(&mut self) -> Residual<D> {
        self.take(0..u64::MAX, Residual::default)
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

    /// What is held now.
    pub(super) fn held(&self) -> Held {
        let ranges = self.finalized.as_ref().map_or(0, FinalizedCells::ranges);
        Held { points: self.current.len() + self.in_buckets, buckets: self.bytes, ranges }
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
    fn take(&mut self, range: std::ops::Range<u64>, fresh: impl FnOnce() -> Residual<D>) -> Residual<D> {
        self.bounds = None;
        self.merging.restart();
        let mut current = Residual::default();
        if !self.current.is_empty() {
            self.accepted += self.current.len() as u64;
            current = std::mem::replace(&mut self.current, fresh());
        }
        let keys: Vec<u64> = self.buckets.range(range).map(|(&key, _)| key).collect();
        if keys.is_empty() {
            return current;
        }
        let mut points = Residual::default();
        for bucket in keys.iter().filter_map(|key| self.buckets.remove(key)) {
            self.in_buckets -= bucket.points.len();
            self.bytes -= bucket.bytes();
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
            let before = if bucket.points.is_empty() { 0 } else { bucket.bytes() };
            bucket.push(point, self.current.row(i));
            self.bytes += bucket.bytes() - before;
        }
        self.in_buckets += self.current.len();
        self.current.clear();
        self.bounds = None;
    }
}

//! The cells of a points stream that are final, and the proof that no later point lies in one.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::model::bounds::{Bounds, Point};
use crate::model::cells::{CellCode, CellTree};
use spmesh_base::error::{Error, Result};

/// The part of a finalization tree that is final.
///
/// The cells of the deepest level are consecutive location codes in Morton order, and every cell is a range
/// of them, so the final part is a set of disjoint ranges. Adjacent ranges are merged: complete siblings
/// become their parent, and a stream that tags its cells along the curve needs only a handful of ranges.
///
/// Cost: `finalize` is amortized O(log ranges). `check_point` costs four comparisons while points stay in the
/// last open cell that was looked up, and O(depth + log ranges) otherwise; it looks up the largest open cell
/// around a point.
#[derive(Debug, Clone)]
pub struct FinalizedCells {
    tree: CellTree,
    /// Codes of the deepest level: start and end of each range.
    ranges: BTreeMap<u64, u64>,
    /// The open cell of the last lookup, half-open, with its codes; it holds no point if there is none.
    open: OpenCell,
    tags: u64,
}

#[derive(Debug, Clone)]
struct OpenCell {
    codes: Range<u64>,
    min: Point,
    max: Point,
}

impl OpenCell {
    /// A cell that holds no point.
    const NONE: OpenCell = OpenCell { codes: 0..0, min: [f64::INFINITY; 3], max: [f64::NEG_INFINITY; 3] };

    fn contains(&self, point: Point, dims: u8) -> bool {
        let inside = |axis: usize| self.min[axis] <= point[axis] && point[axis] < self.max[axis];
        inside(0) && inside(1) && (dims == 2 || inside(2))
    }
}

impl FinalizedCells {
    /// A tree without final cells.
    pub fn new(tree: CellTree) -> Self {
        FinalizedCells { tree, ranges: BTreeMap::new(), open: OpenCell::NONE, tags: 0 }
    }

    /// The tree.
    pub fn tree(&self) -> &CellTree {
        &self.tree
    }

    /// Number of finalized cells.
    pub fn tags(&self) -> u64 {
        self.tags
    }

    /// Number of ranges that describe the final part; memory is proportional to it.
    pub fn ranges(&self) -> usize {
        self.ranges.len()
    }

    /// Makes `cell` final. Parts of it, but not all of it, may be final already.
    ///
    /// # Errors
    /// [`spmesh_base::error::ErrorKind::Malformed`] if `cell` is not a cell of the tree, or is final already:
    /// by itself, through an ancestor, or through all of its parts.
    pub fn finalize(&mut self, cell: CellCode) -> Result<()> {
        if !self.tree.is_valid(cell) {
            return Err(Error::malformed(format!("location code {} is not a cell of the tree", cell.0)));
        }
        if self.is_final_cell(cell) {
            return Err(Error::malformed(format!("cell {} is final already", cell.0)));
        }
        let Range { mut start, mut end } = self.tree.deepest_range(cell);
        if self.open.codes.start < end && start < self.open.codes.end {
            self.open = OpenCell::NONE;
        }
        // Merge ranges that start inside the cell or right after it, and then a range that reaches its start.
        while let Some((&inner, &inner_end)) = self.ranges.range(start..=end).next() {
            end = end.max(inner_end);
            self.ranges.remove(&inner);
        }
        if let Some((&before, &before_end)) = self.ranges.range(..start).next_back()
            && before_end >= start
        {
            start = before;
            end = end.max(before_end);
        }
        self.ranges.insert(start, end);
        self.tags += 1;
        Ok(())
    }

    /// Whether all of `cell`, a cell of the tree, is final.
    pub fn is_final_cell(&self, cell: CellCode) -> bool {
        let codes = self.tree.deepest_range(cell);
        self.ranges.range(..=codes.start).next_back().is_some_and(|(_, &end)| codes.end <= end)
    }

    /// Whether no part of `cell`, a cell of the tree, is final.
    pub fn is_open_cell(&self, cell: CellCode) -> bool {
        let codes = self.tree.deepest_range(cell);
        self.ranges.range(..codes.end).next_back().is_none_or(|(_, &end)| end <= codes.start)
    }

    /// Whether `point` lies in the final part; false for points outside of the tree's cube.
    pub fn is_final(&self, point: Point) -> bool {
        self.tree.contains(point) && self.is_final_cell(self.tree.cell_of(point, self.tree.depth()))
    }

    /// Whether the whole tree is final, so that no point can follow.
    pub fn is_complete(&self) -> bool {
        self.is_final_cell(CellCode::ROOT)
    }

    /// Checks that a point may still arrive.
    ///
    /// # Errors
    /// [`spmesh_base::error::ErrorKind::Malformed`] if it lies in the final part, or outside of the tree's
    /// cube.
    #[inline]
    pub fn check_point(&mut self, point: Point) -> Result<()> {
        if self.open.contains(point, self.tree.dims()) { Ok(()) } else { self.look_up(point) }
    }

    /// Checks that points may still arrive.
    ///
    /// # Errors
    /// As [`FinalizedCells::check_point`], for the first invalid point.
    pub fn check_points(&mut self, points: &[Point]) -> Result<()> {
        points.iter().try_for_each(|&point| self.check_point(point))
    }

    /// Checks that points with the bounding box `bounds` may still arrive. If the box lies in one open cell,
    /// a single check is enough.
    ///
    /// # Errors
    /// As [`FinalizedCells::check_point`], for the first invalid point.
    pub fn check_points_in(&mut self, points: &[Point], bounds: &Bounds) -> Result<()> {
        let Some(&first) = points.first() else { return Ok(()) };
        self.check_point(first)?;
        let dims = self.tree.dims();
        if self.open.contains(bounds.min, dims) && self.open.contains(bounds.max, dims) {
            return Ok(());
        }
        self.check_points(points)
    }

    /// Checks a point by its location code, and remembers the largest open cell around it.
    #[cold]
    fn look_up(&mut self, point: Point) -> Result<()> {
        if !self.tree.contains(point) {
            return Err(Error::malformed(format!("point {point:?} lies outside of the finalization tree")));
        }
        let mut cell = self.tree.cell_of(point, self.tree.depth());
        if self.is_final_cell(cell) {
            return Err(Error::malformed(format!("point {point:?} lies in a cell that is final")));
        }
        while let Some(parent) = self.tree.parent(cell).filter(|&parent| self.is_open_cell(parent)) {
            cell = parent;
        }
        let (min, max) = self.tree.corners(cell);
        self.open = OpenCell { codes: self.tree.deepest_range(cell), min, max };
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    fn tree(dims: u8, depth: u8) -> CellTree {
        let origin = if dims == 3 { [-16.0, -16.0, -8.0] } else { [-8.0, -8.0, 0.0] };
        CellTree::new(dims, depth, origin, 32.0).unwrap()
    }

    /// A linear congruential generator, enough to pick cells and points.
    struct Random(u64);

    impl Random {
        fn below(&mut self, bound: u64) -> u64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 33) % bound
        }
    }

    #[test]
    fn agrees_with_a_set_of_deepest_cells() {
        for seed in 0..200 {
            let mut random = Random(seed);
            let dims = 2 + (seed % 2) as u8;
            let tree = tree(dims, 3);
            let mut cells = FinalizedCells::new(tree);
            let mut reference = HashSet::new();
            for _ in 0..200 {
                let level = random.below(4) as u8;
                let first = 1u64 << (dims * level);
                let cell = CellCode(first + random.below(first));
                let deepest: Vec<u64> = tree.deepest_range(cell).collect();
                let was_final = deepest.iter().all(|code| reference.contains(code));
                assert_eq!(cells.is_final_cell(cell), was_final);
                assert_eq!(cells.is_open_cell(cell), !deepest.iter().any(|code| reference.contains(code)));
                if random.below(4) == 0 && (level > 0 || random.below(20) == 0) {
                    assert_eq!(cells.finalize(cell).is_err(), was_final);
                    reference.extend(deepest);
                }
                let origin = tree.origin();
                let point = std::array::from_fn(|axis| origin[axis] + random.below(64) as f64 / 2.0);
                let code = tree.cell_of(point, 3).0;
                assert_eq!(cells.is_final(point), reference.contains(&code), "seed {seed}");
                assert_eq!(cells.check_point(point).is_err(), reference.contains(&code), "seed {seed}");
            }
        }
    }

    #[test]
    fn complete_siblings_are_their_parent() {
        let tree = tree(2, 10);
        let mut cells = FinalizedCells::new(tree);
        for code in tree.deepest_range(CellCode::ROOT) {
            cells.finalize(CellCode(code)).unwrap();
            assert_eq!(cells.ranges(), 1);
        }
        assert!(cells.is_complete());
        assert_eq!(cells.tags(), 1 << 20);
        assert!(cells.finalize(CellCode::ROOT).is_err());
    }

    #[test]
    fn points_outside_of_the_tree_are_refused() {
        let mut cells = FinalizedCells::new(tree(2, 2));
        assert!(cells.check_point([-8.0, -8.0, 1e9]).is_ok());
        assert!(cells.check_point([24.0, 0.0, 0.0]).is_err());
        assert!(cells.check_point([f64::NAN, 0.0, 0.0]).is_err());
        assert!(cells.finalize(CellCode(2)).is_err());
        assert!(cells.finalize(CellCode(0)).is_err());
        assert!(cells.finalize(CellCode(64)).is_err());
        assert!(!cells.is_final([24.0, 0.0, 0.0]));
    }

    #[test]
    fn a_cell_of_the_deepest_possible_level_is_one_code() {
        let tree = CellTree::new(2, 31, [0.0; 3], 2f64.powi(31)).unwrap();
        let mut cells = FinalizedCells::new(tree);
        let last = tree.cell_of([2f64.powi(31) - 1.0; 3], 31);
        cells.finalize(last).unwrap();
        assert!(cells.check_point([2f64.powi(31) - 1.0; 3]).is_err());
        assert!(cells.check_point([2f64.powi(31) - 2.0; 3]).is_ok());
        cells.finalize(CellCode::ROOT).unwrap();
        assert!(cells.is_complete());
    }
}

//! The part of space that is tagged final, as intervals of the deepest cells in Morton order.
//!
//! The audit locates points with arithmetic of its own, by halving the cube. Every border is exact, because
//! the tree admits no others.

use std::collections::BTreeMap;
use std::ops::Range;

use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::cells::{CellCode, CellTree};

/// Disjoint, not adjacent intervals of codes. Memory: their number.
#[derive(Debug, Default)]
pub(super) struct CodeSet {
    ends: BTreeMap<u64, u64>,
}

impl CodeSet {
    pub(super) fn insert(&mut self, codes: Range<u64>) {
        let (mut start, mut end) = (codes.start, codes.end);
        while let Some((&other_start, &other_end)) = self.ends.range(..=end).next_back() {
            if other_end < start {
                break;
            }
            self.ends.remove(&other_start);
            start = start.min(other_start);
            end = end.max(other_end);
        }
        self.ends.insert(start, end);
    }

    /// Whether the set holds all of `codes`. Intervals that touch are merged, so one interval must hold them
    /// all.
    pub(super) fn covers(&self, codes: Range<u64>) -> bool {
        self.ends.range(..=codes.start).next_back().is_some_and(|(_, &end)| end >= codes.end)
    }

    pub(super) fn contains(&self, code: u64) -> bool {
        self.covers(code..code + 1)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }
}

/// The codes of the deepest cells inside of `cell`.
pub(super) fn codes_of(tree: &CellTree, cell: CellCode) -> Range<u64> {
    let dims = u32::from(tree.dims());
    let level = cell.0.ilog2() / dims;
    let shift = dims * (u32::from(tree.depth()) - level);
    cell.0 << shift..(cell.0 + 1) << shift
}

/// Code of the deepest cell that holds `point`; `None` outside of the cube.
pub(super) fn code_of(tree: &CellTree, point: Point) -> Option<u64> {
    let axes = 0..usize::from(tree.dims());
    let (mut low, mut half) = (tree.origin(), tree.side());
    if axes.clone().any(|axis| point[axis] < low[axis] || point[axis] >= low[axis] + half) {
        return None;
    }
    let mut code = 1;
    for _ in 0..tree.depth() {
        half /= 2.0;
        let mut child = 0;
        for axis in axes.clone() {
            let middle = low[axis] + half;
            if point[axis] >= middle {
                low[axis] = middle;
                child |= 1 << axis;
            }
        }
        code = code << tree.dims() | child;
    }
    Some(code)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_merge_and_are_found() {
        let mut set = CodeSet::default();
        for codes in [4..6, 10..12, 6..7, 1..2, 8..10] {
            assert!(!set.covers(codes.clone()));
            set.insert(codes);
        }
        assert_eq!(set.ends.iter().collect::<Vec<_>>(), [(&1, &2), (&4, &7), (&8, &12)]);
        let held: Vec<u64> = (0..14).filter(|&code| set.contains(code)).collect();
        assert_eq!(held, [1, 4, 5, 6, 8, 9, 10, 11]);
        assert!(set.covers(5..7) && !set.covers(6..8) && !set.covers(7..9));
        set.insert(0..20);
        assert_eq!(set.ends.len(), 1);
    }

    #[test]
    fn a_point_lies_in_the_codes_of_its_cell() {
        let tree = CellTree::new(3, 4, [-8.0, 0.0, 16.0], 16.0).unwrap();
        for point in [[-8.0, 0.0, 16.0], [7.9, 15.9, 31.9], [0.0, 7.99, 24.0]] {
            let code = code_of(&tree, point).unwrap();
            for level in 0..=4 {
                assert!(codes_of(&tree, tree.cell_of(point, level)).contains(&code));
            }
        }
        assert_eq!(code_of(&tree, [8.0, 0.0, 16.0]), None);
    }
}

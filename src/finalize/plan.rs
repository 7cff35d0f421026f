//! The finalization tree: which cells are leaves, which are empty, and the leaf of a point.

use super::buffer::CELL_COST;
use super::survey::{Grid, input_changed};
use super::{Budget, Leaves};
use crate::bounds::Point;
use crate::cells::{CellCode, CellTree};
use crate::error::{Error, ErrorKind, Result};

/// Bytes that a leaf takes up while its points wait: its code, its counter, and the state of its buffer.
const LEAF_COST: u64 = PLAN_COST + CELL_COST;

/// Bytes of code and counter of a leaf.
const PLAN_COST: u64 = 16;

/// Leaves and empty cells of the tree, which together fill the cube without overlap, and the number of
/// points that each leaf still expects.
pub(super) struct Plan {
    tree: CellTree,
    /// Maximal cells without points, in the order of the tree.
    empty: Vec<CellCode>,
    /// In the order of the tree: increasing, when extended to the same depth.
    leaves: Vec<CellCode>,
    remaining: Vec<u64>,
    /// The leaf of the last point: the next one is often in it.
    last: usize,
    count_max: u64,
}

impl Plan {
    /// Chooses the leaves from the counts.
    ///
    /// # Errors
    /// [`ErrorKind::Memory`] if so many leaves do not fit.
    pub(super) fn new(grid: Grid, rule: Leaves, budget: &Budget) -> Result<Plan> {
        let (mut leaves, mut empty, mut depth) = (0u64, 0u64, 0);
        visit(&grid, rule, CellCode::ROOT, &mut |cell, count| {
            depth = depth.max(grid.tree.level(cell));
            *(if count == 0 { &mut empty } else { &mut leaves }) += 1;
        });
        if leaves * LEAF_COST + empty * 8 > budget.leaves() {
            return Err(Error::new(
                ErrorKind::Memory,
                format!(
                    "{leaves} leaves do not fit the memory budget: choose a smaller level, more points per cell, or more memory"
                ),
            ));
        }
        let tree = CellTree::new(grid.tree.dims(), depth, grid.tree.origin(), grid.tree.side())
            .expect("a tree that is less deep is as exact");
        let mut plan = Plan {
            tree,
            empty: Vec::with_capacity(empty as usize),
            leaves: Vec::with_capacity(leaves as usize),
            remaining: Vec::with_capacity(leaves as usize),
            last: 0,
            count_max: 0,
        };
        visit(&grid, rule, CellCode::ROOT, &mut |cell, count| plan.enter(cell, count));
        Ok(plan)
    }

    fn enter(&mut self, cell: CellCode, count: u64) {
        if count == 0 {
            self.empty.push(cell);
        } else {
            self.leaves.push(cell);
            self.remaining.push(count);
            self.count_max = self.count_max.max(count);
        }
    }

    /// The tree, as deep as its deepest leaf.
    pub(super) fn tree(&self) -> CellTree {
        self.tree
    }

    /// Number of leaves.
    pub(super) fn leaves(&self) -> usize {
        self.leaves.len()
    }

    /// Memory that codes and counters take up.
    pub(super) fn bytes(&self) -> u64 {
        self.leaves.len() as u64 * PLAN_COST
    }

    /// The maximal empty cells.
    pub(super) fn empty(&self) -> &[CellCode] {
        &self.empty
    }

    /// Forgets the empty cells and tells them.
    pub(super) fn take_empty(&mut self) -> Vec<CellCode> {
        std::mem::take(&mut self.empty)
    }

    /// Number of points in the fullest leaf.
    pub(super) fn count_max(&self) -> u64 {
        self.count_max
    }

    /// The cell that is leaf number `leaf`.
    pub(super) fn cell(&self, leaf: usize) -> CellCode {
        self.leaves[leaf]
    }

    /// Number of the leaf that holds `point`, whose counter goes down, and whether it was its last point.
    ///
    /// # Errors
    /// If `point` was not counted: outside of the cube, in an empty cell, or one too many.
    pub(super) fn expect(&mut self, point: Point) -> Result<(usize, bool)> {
        if !self.tree.contains(point) {
            return Err(input_changed());
        }
        let code = self.tree.cell_of(point, self.tree.depth()).0;
        if !self.holds(self.last, code) {
            self.last = self.leaves.partition_point(|leaf| extend(leaf.0, code) <= code).saturating_sub(1);
        }
        let leaf = self.last;
        if !self.holds(leaf, code) || self.remaining[leaf] == 0 {
            return Err(input_changed());
        }
        self.remaining[leaf] -= 1;
        Ok((leaf, self.remaining[leaf] == 0))
    }

    /// Fails unless every point that was counted has come.
    pub(super) fn expect_end(&self) -> Result<()> {
        if self.remaining.iter().all(|&remaining| remaining == 0) { Ok(()) } else { Err(input_changed()) }
    }

    fn holds(&self, leaf: usize, code: u64) -> bool {
        let leaf = self.leaves[leaf].0;
        code >> (leaf.leading_zeros() - code.leading_zeros()) == leaf
    }
}

/// The first descendant of `cell` that is as deep as `code`.
fn extend(cell: u64, code: u64) -> u64 {
    cell << (cell.leading_zeros() - code.leading_zeros())
}

/// Calls `found` with every leaf and every maximal empty cell below `cell`, and the number of points in it.
fn visit(grid: &Grid, rule: Leaves, cell: CellCode, found: &mut impl FnMut(CellCode, u64)) {
    let (count, is_finer_known) = grid.count(cell);
    let is_divided = count > 0
        && match rule {
            Leaves::Collapsed { cell_points, .. } => count > cell_points && is_finer_known,
            Leaves::Level(_) => is_finer_known,
        };
    if !is_divided {
        return found(cell, count);
    }
    let first = cell.0 << grid.tree.dims();
    for child in first..first + (1 << grid.tree.dims()) {
        visit(grid, rule, CellCode(child), found);
    }
}

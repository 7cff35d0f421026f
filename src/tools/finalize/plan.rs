//! The finalization tree: which cells are leaves, which are empty, and how many points each leaf expects.

use super::buffer::CELL_COST;
use super::locate::Locator;
use super::survey::{Grid, input_changed};
use super::{Budget, Leaves};
use spmesh_core::error::{Error, ErrorKind, Result};
use spmesh_model::cells::{CellCode, CellTree};

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
    table_bytes: u64,
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
            table_bytes: budget.table(),
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

    /// Memory that codes, counters and the table of cells take up.
    pub(super) fn bytes(&self) -> u64 {
        self.leaves.len() as u64 * PLAN_COST + self.table_bytes
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

    /// What tells the leaf of a point, and what counts the points that are still to come.
    pub(super) fn split(self) -> (Locator, Countdown) {
        (Locator::new(self.tree, self.leaves, self.table_bytes), Countdown { remaining: self.remaining })
    }
}

/// The number of points that each leaf still expects.
pub(super) struct Countdown {
    remaining: Vec<u64>,
}

impl Countdown {
    /// Takes `points` points of `leaf`, and whether none are left.
    ///
    /// # Errors
    /// If more points have come than were counted.
    pub(super) fn take(&mut self, leaf: usize, points: usize) -> Result<bool> {
        let remaining = &mut self.remaining[leaf];
        *remaining = remaining.checked_sub(points as u64).ok_or_else(input_changed)?;
        Ok(*remaining == 0)
    }

    /// Fails unless every point that was counted has come.
    pub(super) fn expect_end(&self) -> Result<()> {
        if self.remaining.iter().all(|&remaining| remaining == 0) { Ok(()) } else { Err(input_changed()) }
    }
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

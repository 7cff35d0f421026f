//! The finalization tree: which cells are leaves, which are empty, and how many points each leaf expects.

use super::budget::Budget;
use super::buffer::CELL_COST;
use super::counters::CellCounts;
use super::locate::Locator;
use super::options::Leaves;
use super::passes::input_changed;
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_stream::model::cells::{CellCode, CellTree};

/// Bytes per leaf while its points wait: its code, its counter, and the state of its buffer.
const LEAF_COST: u64 = PLAN_COST + CELL_COST;

/// Bytes of the code and the counter of a leaf.
const PLAN_COST: u64 = 16;

/// Leaves and empty cells of the tree, which together fill the cube without overlap, and the number of points
/// that each leaf still expects.
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
    pub(super) fn new(counts: CellCounts, rule: Leaves, budget: &Budget) -> Result<Plan> {
        let (mut leaves, mut empty, mut depth) = (0u64, 0u64, 0);
        visit(&counts, rule, CellCode::ROOT, &mut |cell, count| {
            depth = depth.max(counts.tree.level(cell));
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
        let tree = CellTree::new(counts.tree.dims(), depth, counts.tree.origin(), counts.tree.side())
            .expect("a tree that is less deep is as exact");
        let mut plan = Plan {
            tree,
            empty: Vec::with_capacity(empty as usize),
            leaves: Vec::with_capacity(leaves as usize),
            remaining: Vec::with_capacity(leaves as usize),
            table_bytes: budget.table(),
            count_max: 0,
        };
        visit(&counts, rule, CellCode::ROOT, &mut |cell, count| plan.enter(cell, count));
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

    /// The cells that are leaves, in the order of the tree.
    pub(super) fn cells(&self) -> &[CellCode] {
        &self.leaves
    }

    /// Number of leaves.
    pub(super) fn leaves(&self) -> usize {
        self.leaves.len()
    }

    /// Bytes of codes, counters and the table of cells.
    pub(super) fn bytes(&self) -> u64 {
        self.leaves.len() as u64 * PLAN_COST + self.table_bytes
    }

    /// The maximal empty cells.
    pub(super) fn empty(&self) -> &[CellCode] {
        &self.empty
    }

    /// Takes the empty cells out of the plan.
    pub(super) fn take_empty(&mut self) -> Vec<CellCode> {
        std::mem::take(&mut self.empty)
    }

    /// Number of points in the fullest leaf.
    pub(super) fn count_max(&self) -> u64 {
        self.count_max
    }

    /// The locator of leaves, and the countdown of their points.
    pub(super) fn split(self) -> (Locator, Countdown) {
        (Locator::new(self.tree, self.leaves, self.table_bytes), Countdown { remaining: self.remaining })
    }
}

/// The number of points that each leaf still expects.
pub(super) struct Countdown {
    remaining: Vec<u64>,
}

impl Countdown {
    /// Counts `points` points of `leaf`. Returns whether the leaf is complete.
    pub(super) fn take(&mut self, leaf: usize, points: usize) -> Result<bool> {
        let remaining = &mut self.remaining[leaf];
        *remaining = remaining.checked_sub(points as u64).ok_or_else(input_changed)?;
        Ok(*remaining == 0)
    }

    /// Checks that all leaves are complete.
    pub(super) fn expect_end(&self) -> Result<()> {
        if self.remaining.iter().all(|&remaining| remaining == 0) { Ok(()) } else { Err(input_changed()) }
    }
}

/// Calls `found` with every leaf and every maximal empty cell below `cell`, and the number of points in it.
fn visit(counts: &CellCounts, rule: Leaves, cell: CellCode, found: &mut impl FnMut(CellCode, u64)) {
    let (count, is_finer_known) = counts.count(cell);
    let is_divided = count > 0
        && match rule {
            Leaves::Collapsed { cell_points, .. } => count > cell_points && is_finer_known,
            Leaves::Level(_) => is_finer_known,
        };
    if !is_divided {
        return found(cell, count);
    }
    let first = cell.0 << counts.tree.dims();
    for child in first..first + (1 << counts.tree.dims()) {
        visit(counts, rule, CellCode(child), found);
    }
}

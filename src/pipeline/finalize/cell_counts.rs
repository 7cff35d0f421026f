//! Counts per cell of a finalization tree.

use super::counters::CellSums;
use spmesh_stream::model::cells::{CellCode, CellTree};

/// Counts per cell of a tree, on finer grids where cells are crowded.
pub(super) struct CellCounts {
    /// Tree of the deepest level that leaves may have.
    pub(super) tree: CellTree,
    /// Grids of counts, each finer than the one before: the first of all points, the others of crowded cells.
    pub(super) sums: Vec<CellSums>,
    /// A cell with more points is crowded.
    pub(super) crowded: u64,
}

impl CellCounts {
    /// Number of points in `cell`, and whether the counts of its children are known. The count of `cell`
    /// itself must be known.
    pub(super) fn count(&self, cell: CellCode) -> (u64, bool) {
        let level = self.tree.level(cell);
        let at = self.sums.partition_point(|sums| sums.level() < level);
        let count = self.sums[at].count(cell);
        let is_finer_known =
            level < self.sums[at].level() || (count > self.crowded && at + 1 < self.sums.len());
        (count, is_finer_known)
    }

    /// The counts of the finest grid.
    pub(super) fn finest(&self) -> &CellSums {
        self.sums.last().expect("a grid has counts")
    }

    /// Sets the codes of cells outside of crowded cells to 0; `deepest` are cells of the deepest level.
    pub(super) fn keep_crowded(&self, deepest: &mut [CellCode]) {
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

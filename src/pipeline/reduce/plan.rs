//! The nodes, the order in which they are written, and the nodes whose residuals each of them takes.

use std::collections::BTreeMap;

use spmesh_stream::model::cells::{CellCode, CellTree};

/// Nodes without a parent yet, keyed by the first deepest cell of their cell, so that the nodes below a cell
/// are a range. Cells without points have no nodes: there may be far more of them.
///
/// The plan depends on the order of the tags alone, and so not on the number of threads.
///
/// Invariant: no node without a parent contains another.
pub(super) struct Plan {
    tree: Option<CellTree>,
    waiting: BTreeMap<u64, (CellCode, u64)>,
    next: u64,
}

impl Plan {
    pub(super) fn new(tree: Option<CellTree>) -> Self {
        Plan { tree, waiting: BTreeMap::new(), next: 0 }
    }

    /// Takes the nodes inside `cell` that have no parent: their numbers in Morton order.
    pub(super) fn take(&mut self, cell: CellCode) -> Vec<u64> {
        let range = self.range(cell);
        let keys: Vec<u64> = self.waiting.range(range).map(|(&key, _)| key).collect();
        keys.iter().filter_map(|key| self.waiting.remove(key)).map(|(_, number)| number).collect()
    }

    /// Plans the node of `cell`, after [`Plan::take`]. Returns its number, which is its place in the order of
    /// writing.
    pub(super) fn node(&mut self, cell: CellCode) -> u64 {
        let number = self.number();
        self.waiting.insert(self.range(cell).start, (cell, number));
        number
    }

    /// The number of a node below the next one.
    pub(super) fn number(&mut self) -> u64 {
        self.next += 1;
        self.next - 1
    }

    /// The cell one level up.
    pub(super) fn parent(&self, cell: CellCode) -> Option<CellCode> {
        self.tree.as_ref()?.parent(cell)
    }

    /// Whether no node but that of the root lacks a parent.
    pub(super) fn is_complete(&self) -> bool {
        self.waiting.values().all(|(cell, _)| *cell == CellCode::ROOT)
    }

    fn range(&self, cell: CellCode) -> std::ops::Range<u64> {
        self.tree.as_ref().map_or(0..u64::MAX, |tree| tree.deepest_range(cell))
    }
}

//! The nodes, the order in which they are written, and the nodes whose residuals each of them takes.

use std::collections::BTreeMap;

use spmesh_stream::model::cells::{CellCode, CellTree};

/// Nodes without a parent yet, keyed by the first deepest cell of their cell, so that the nodes below a cell
/// are a range.
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

    /// Plans the node of `cell` as the parent of all nodes inside that have none. Returns the number of the
    /// node, which is its place in the order of writing, and the numbers of its children in Morton order.
    pub(super) fn node(&mut self, cell: CellCode) -> (u64, Vec<u64>) {
        let range = self.range(cell);
        let keys: Vec<u64> = self.waiting.range(range.clone()).map(|(&key, _)| key).collect();
        let children =
            keys.iter().filter_map(|key| self.waiting.remove(key)).map(|(_, number)| number).collect();
        let number = self.number();
        self.waiting.insert(range.start, (cell, number));
        (number, children)
    }

    /// The number of a node below the next one.
    pub(super) fn number(&mut self) -> u64 {
        self.next += 1;
        self.next - 1
    }

    /// Parent of `cell`, if all its children have nodes.
    pub(super) fn complete_parent(&self, cell: CellCode) -> Option<CellCode> {
        let tree = self.tree.as_ref()?;
        let parent = tree.parent(cell)?;
        let waits =
            |child| self.waiting.get(&self.range(child).start).is_some_and(|(code, _)| *code == child);
        tree.children(parent).all(waits).then_some(parent)
    }

    /// Whether the root has a node.
    pub(super) fn is_complete(&self) -> bool {
        self.waiting.values().any(|(cell, _)| *cell == CellCode::ROOT)
    }

    fn range(&self, cell: CellCode) -> std::ops::Range<u64> {
        self.tree.as_ref().map_or(0..u64::MAX, |tree| tree.deepest_range(cell))
    }
}

//! The residuals of finished nodes whose parent is not finished.

use std::collections::BTreeMap;

use super::residual::{Residual, union};
use crate::bounds::{Bounds, Region};
use crate::cells::{CellCode, CellTree};

/// Residuals that wait, keyed by the first deepest cell of their node, so that the nodes below a cell are a
/// range.
///
/// Invariant: no node that waits contains another.
pub(super) struct Pending {
    tree: Option<CellTree>,
    waiting: BTreeMap<u64, (CellCode, Residual)>,
    points: usize,
    points_max: usize,
    active: usize,
    active_max: usize,
}

impl Pending {
    pub(super) fn new(tree: Option<CellTree>) -> Self {
        Pending { tree, waiting: BTreeMap::new(), points: 0, points_max: 0, active: 0, active_max: 0 }
    }

    /// Lets the residual of `cell` wait.
    pub(super) fn insert(&mut self, cell: CellCode, residual: Residual) {
        self.points += residual.len();
        self.points_max = self.points_max.max(self.points);
        self.active += residual.active;
        self.active_max = self.active_max.max(self.active);
        let before = self.waiting.insert(self.first(cell), (cell, residual));
        debug_assert!(before.is_none(), "{cell:?} waits already");
    }

    /// Parent of `cell`, if all its children wait.
    pub(super) fn complete_parent(&self, cell: CellCode) -> Option<CellCode> {
        let tree = self.tree.as_ref()?;
        let parent = tree.parent(cell)?;
        let waits = |child| self.waiting.get(&self.first(child)).is_some_and(|(code, _)| *code == child);
        tree.children(parent).all(waits).then_some(parent)
    }

    /// Takes the residuals of all nodes inside `cell`, joined in Morton order.
    pub(super) fn take_below(&mut self, cell: CellCode) -> Residual {
        let keys: Vec<u64> = self.waiting.range(self.range(cell)).map(|(&key, _)| key).collect();
        let parts: Vec<Residual> =
            keys.iter().filter_map(|key| self.waiting.remove(key)).map(|(_, residual)| residual).collect();
        let all = union(&parts);
        self.points -= all.len();
        self.active -= all.active;
        all
    }

    /// Whether the root, and so everything, is done.
    pub(super) fn is_complete(&self) -> bool {
        self.waiting.values().any(|(cell, _)| *cell == CellCode::ROOT)
    }

    /// Most residual points that waited at once.
    pub(super) fn points_max(&self) -> usize {
        self.points_max
    }

    /// Most triangles that were not final at the nodes that waited at once.
    pub(super) fn active_max(&self) -> usize {
        self.active_max
    }

    fn range(&self, cell: CellCode) -> std::ops::Range<u64> {
        self.tree.as_ref().map_or(0..u64::MAX, |tree| tree.deepest_range(cell))
    }

    fn first(&self, cell: CellCode) -> u64 {
        self.range(cell).start
    }
}

/// The boxes of nodes, opened to where no further point can lie.
#[derive(Debug, Clone, Copy)]
pub(super) struct Boxes {
    tree: Option<CellTree>,
    /// Smallest known box of all points, closed.
    extent: Region,
    /// What a side becomes beyond which the run sees no point: the region of a partial run, else the plane.
    outer: Region,
}

impl Boxes {
    pub(super) fn new(tree: Option<CellTree>, bounds: Option<Bounds>, outer: Region) -> Self {
        let cube = |tree: &CellTree| {
            let (min, max) = tree.corners(CellCode::ROOT);
            Region { min: [min[0], min[1]], max: [max[0].next_down(), max[1].next_down()] }
        };
        let known = |bounds: Bounds| Region {
            min: [bounds.min[0], bounds.min[1]],
            max: [bounds.max[0], bounds.max[1]],
        };
        let extent = bounds.map(known).or(tree.as_ref().map(cube)).unwrap_or(Region::PLANE);
        Boxes { tree, extent, outer }
    }

    /// The region outside of which points other than those of `cell` may lie.
    ///
    /// A side at or beyond the border of all points moves out to the outer region: there is nothing between.
    pub(super) fn region(&self, cell: CellCode) -> Region {
        let Some(tree) = self.tree.filter(|_| cell != CellCode::ROOT) else { return self.outer };
        let (min, max) = tree.corners(cell);
        let mut region = self.outer;
        for axis in 0..2 {
            if min[axis] > self.extent.min[axis] {
                region.min[axis] = region.min[axis].max(min[axis]);
            }
            if max[axis] <= self.extent.max[axis] {
                region.max[axis] = region.max[axis].min(max[axis]);
            }
        }
        region
    }
}

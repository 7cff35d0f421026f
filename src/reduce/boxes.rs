//! The boxes of nodes, opened to where no further point can lie.

use crate::bounds::{Bounds, Region};
use crate::cells::{CellCode, CellTree};

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

//! The boxes of nodes, opened to where no further point can lie.

use spmesh_stream::model::bounds::{Bounds, Region};
use spmesh_stream::model::cells::{CellCode, CellTree};

/// The boxes of nodes, opened to where no further point can lie.
#[derive(Debug, Clone, Copy)]
pub(super) struct Boxes<const D: usize> {
    tree: Option<CellTree>,
    /// Smallest known box of all points, closed.
    extent: Region<D>,
    /// The region of a partial run, or everything: the run sees no point outside of it.
    outer: Region<D>,
}

impl<const D: usize> Boxes<D> {
    pub(super) fn new(tree: Option<CellTree>, bounds: Option<Bounds>, outer: Region<D>) -> Self {
        let cube = |tree: &CellTree| {
            let (min, max) = tree.corners(CellCode::ROOT);
            Region::between(min, max.map(f64::next_down))
        };
        let known = |bounds: Bounds| Region::between(bounds.min, bounds.max);
        let extent = bounds.map(known).or(tree.as_ref().map(cube)).unwrap_or(Region::EVERYTHING);
        Boxes { tree, extent, outer }
    }

    /// The region outside of which points other than those of `cell` may lie.
    ///
    /// A side on or outside of the border of all points moves out to the outer region, because no point lies
    /// between.
    pub(super) fn region(&self, cell: CellCode) -> Region<D> {
        let Some(tree) = self.tree.filter(|_| cell != CellCode::ROOT) else { return self.outer };
        let (min, max) = tree.corners(cell);
        let mut region = self.outer;
        for axis in 0..D {
            if min[axis] > self.extent.min[axis] {
                region.min[axis] = region.min[axis].max(min[axis]);
            }
            if max[axis] <= self.extent.max[axis] {
                region.max[axis] = region.max[axis].min(max[axis]);
            }
        }
        region
    }

    /// Whether the run sees no point outside of the region of a node. The node may be below the root of the
    /// tree, because the side of the root is a power of two and so may be longer than the extent of the
    /// points.
    pub(super) fn is_everything(&self, region: &Region<D>) -> bool {
        *region == self.outer
    }
}

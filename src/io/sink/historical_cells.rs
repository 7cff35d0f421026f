//! Finalization tags of the historical point formats: cells by level and quadrant, in a box.

use crate::cell_index::{index_of, level_max};
use spmesh_model::bounds::{Bounds, Point};
use spmesh_model::cells::{CellCode, CellTree};
use spmesh_stream::{Coordinates, Header};

/// The tree of a stream, as a box of world coordinates whose halves are the cells.
///
/// SPA and SPB state no tree: it is their bounding box, halved again and again, a point on a middle belonging
/// to the upper half. For f64 coordinates the box is the cube itself, whose middles are exact. Integer
/// coordinates become world coordinates by rounding, so their box is moved down by half a step: then
/// no point lies near a border, and no rounding moves one across.
pub(super) struct HistoricalCells {
    tree: CellTree,
    min: Point,
    max: Point,
    skipped: u64,
    is_complete: bool,
}

impl HistoricalCells {
    /// The tree of the header as a box; `None` if there is none, or if its cells split the steps of the grid.
    pub(super) fn of(header: &Header) -> Option<Self> {
        let tree = header.tree?;
        let (mut min, mut max) = tree.corners(CellCode::ROOT);
        if let Coordinates::I32 { .. } = header.coordinates {
            let finest = tree.side() / 2f64.powi(i32::from(tree.depth().min(level_max(tree.dims()))));
            if finest < 1.0 || min.iter().any(|x| x.fract() != 0.0) {
                return None;
            }
            min = min.map(|x| x - 0.5);
            max = max.map(|x| x - 0.5);
        }
        let (min, max) = (header.coordinates.to_world(min), header.coordinates.to_world(max));
        let mut cells = HistoricalCells { tree, min, max, skipped: 0, is_complete: false };
        if tree.dims() == 2 {
            cells.set_height(header);
        }
        Some(cells)
    }

    /// The box.
    pub(super) fn bounds(&self) -> Bounds {
        Bounds { min: self.min, max: self.max }
    }

    /// Name of the tree in an SPA header.
    pub(super) fn method(&self) -> &'static str {
        if self.tree.dims() == 2 { "SP_QUAD_TREE" } else { "SP_OCT_TREE" }
    }

    /// Code of the tree in an SPB header.
    pub(super) fn method_code(&self) -> u8 {
        self.tree.dims() - 1
    }

    /// Index of a cell; `None`, and counted, if it is too deep to have one.
    pub(super) fn index(&mut self, cell: CellCode) -> Option<i32> {
        self.is_complete |= cell == CellCode::ROOT;
        let index = index_of(&self.tree, cell);
        self.skipped += u64::from(index.is_none());
        index
    }

    /// Index of the root, if the stream did not say that it is final: readers of old wait for that.
    pub(super) fn last_index(&self) -> Option<i32> {
        (!self.is_complete).then_some(0)
    }

    /// Number of tags that had no index.
    pub(super) fn skipped(&self) -> u64 {
        self.skipped
    }

    /// A quadtree says nothing of z: the height of the box is that of the points, where known.
    fn set_height(&mut self, header: &Header) {
        let (low, high) = match header.bounds {
            Some(bounds) if header.has_elevation => {
                (header.coordinates.to_world(bounds.min)[2], header.coordinates.to_world(bounds.max)[2])
            }
            _ => (0.0, 0.0),
        };
        (self.min[2], self.max[2]) = (low, high);
    }
}

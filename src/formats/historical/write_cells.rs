//! Finalization tags of the historical point formats: cells by level and quadrant, in a box.

use crate::historical::cell_index::{index_of, level_max};
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::model::cells::{CellCode, CellTree};
use spmesh_stream::{Coordinates, Header};

/// The finalization tree of a stream as a box of world coordinates, which is halved into cells.
///
/// SPA and SPB state no tree. Readers halve the bounding box again and again; a point on a midplane belongs
/// to the upper half. For f64 coordinates the box is the cube itself, whose midplanes are exact. Integer
/// coordinates are rounded to world coordinates, so their box is moved down by half a step: then no point
/// lies near a midplane, and rounding cannot move a point across.
pub(crate) struct HistoricalCells {
    tree: CellTree,
    min: Point,
    max: Point,
    skipped: u64,
    is_complete: bool,
}

impl HistoricalCells {
    /// The box of the header's tree; `None` if there is no tree, or if its cells are not aligned to grid
    /// steps.
    pub(crate) fn of(header: &Header) -> Option<Self> {
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
        let (min, max) = (header.coordinates.to_decimal(min), header.coordinates.to_decimal(max));
        let mut cells = HistoricalCells { tree, min, max, skipped: 0, is_complete: false };
        if tree.dims() == 2 {
            cells.set_height(header);
        }
        Some(cells)
    }

    /// The box.
    pub(crate) fn bounds(&self) -> Bounds {
        Bounds { min: self.min, max: self.max }
    }

    /// Name of the tree in an SPA header.
    pub(crate) fn method(&self) -> &'static str {
        if self.tree.dims() == 2 { "SP_QUAD_TREE" } else { "SP_OCT_TREE" }
    }

    /// Code of the tree in an SPB header.
    pub(crate) fn method_code(&self) -> u8 {
        self.tree.dims() - 1
    }

    /// Index of a cell; `None` if it is too deep to have one. Counts cells without an index.
    pub(crate) fn index(&mut self, cell: CellCode) -> Option<i32> {
        self.is_complete |= cell == CellCode::ROOT;
        let index = index_of(&self.tree, cell);
        self.skipped += u64::from(index.is_none());
        index
    }

    /// Index of the root if the stream did not finalize the root: old readers wait for its tag.
    pub(crate) fn last_index(&self) -> Option<i32> {
        (!self.is_complete).then_some(0)
    }

    /// Number of tags that had no index.
    pub(crate) fn skipped(&self) -> u64 {
        self.skipped
    }

    /// A quadtree has no z extent: the box takes the height of the points, where known.
    fn set_height(&mut self, header: &Header) {
        let (low, high) = match header.bounds {
            Some(bounds) if header.has_elevation => {
                (header.coordinates.to_decimal(bounds.min)[2], header.coordinates.to_decimal(bounds.max)[2])
            }
            _ => (0.0, 0.0),
        };
        (self.min[2], self.max[2]) = (low, high);
    }
}

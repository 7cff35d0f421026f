//! The cells that the tags of SPA and SPB finalize.

use crate::historical::cell_index;
use crate::historical::sp::{SpFinalization, SpHeader};
use spmesh_base::error::{Error, Result};
use spmesh_stream::FinalizedCells;
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::model::cells::{CellCode, CellTree};

/// The tree whose cells the file's tags finalize, if it is exact.
pub(crate) fn tree_of(header: &SpHeader) -> Option<CellTree> {
    let Bounds { min, max } = header.bounds?;
    let dims = match header.finalization {
        SpFinalization::QuadTree => 2,
        SpFinalization::OctTree => 3,
        _ => return None,
    };
    let axes = usize::from(dims);
    let side = max[0] - min[0];
    let is_cube = (0..axes).all(|axis| max[axis] - min[axis] == side && min[axis] + side == max[axis]);
    let mut origin = [0.0; 3];
    origin[..axes].copy_from_slice(&min[..axes]);
    if is_cube { CellTree::new(dims, cell_index::level_max(dims), origin, side) } else { None }
}

/// The cell of a tag; an error if the tree has none.
pub(crate) fn cell_of(index: i32, tree: &CellTree) -> Result<CellCode> {
    let unknown = || Error::malformed(format!("finalized cell {index}, which the tree does not have"));
    cell_index::cell_of(tree, index).ok_or_else(unknown)
}

/// Checks at the end of a file that its tags finalize the cell of its last point: a file that was cut between
/// the points of a cell and its tag ends otherwise. A file without tags tells nothing.
pub(crate) fn check_end(cells: Option<&FinalizedCells>, last: Option<Point>) -> Result<()> {
    match (cells.filter(|cells| cells.tags() > 0), last) {
        (Some(cells), Some(point)) if !cells.is_final(point) => {
            let message = "truncated: the cell of the last point is never finalized, although others are";
            Err(Error::malformed(message))
        }
        _ => Ok(()),
    }
}

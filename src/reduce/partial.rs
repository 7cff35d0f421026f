//! Which part of the plane a run takes.

use crate::bounds::Region;
use crate::cells::CellTree;
use crate::error::{Error, Result};
use crate::stream::{Coordinates, Header};

/// The part of the plane that a partial run triangulates. Points outside of it are left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Part {
    /// A half-open box in world coordinates; sides may be infinite.
    Region(Region),
    /// A cell of the input's finalization tree.
    Cell {
        /// Level; the root has level 0.
        level: u8,
        /// Column, below `2^level`.
        column: u32,
        /// Row, below `2^level`.
        row: u32,
    },
}

impl Part {
    /// The part as a half-open box in stored coordinates.
    ///
    /// # Errors
    /// If the box is empty, or the tree has no such cell.
    pub(super) fn region(&self, header: &Header) -> Result<Region> {
        match *self {
            Part::Region(region) => stored_region(&region, &header.coordinates),
            Part::Cell { level, column, row } => {
                let tree = header.tree.ok_or_else(|| {
                    Error::usage("the input has no finalization tree: give a region instead of a cell")
                })?;
                cell_region(&tree, level, column, row)
            }
        }
    }
}

/// A world box in stored coordinates. The map is monotone, so boxes that share a side still do. A side that
/// names a grid point up to rounding lies on it, so that the point is on the border.
fn stored_region(region: &Region, coordinates: &Coordinates) -> Result<Region> {
    let stored = |corner: [f64; 2]| -> [f64; 2] {
        match coordinates {
            Coordinates::F64 => corner,
            Coordinates::I32 { scale, offset } => {
                std::array::from_fn(|axis| on_grid((corner[axis] - offset[axis]) / scale[axis]))
            }
        }
    };
    let stored = Region { min: stored(region.min), max: stored(region.max) };
    if (0..2).all(|axis| stored.min[axis] < stored.max[axis]) {
        Ok(stored)
    } else {
        Err(Error::usage("the region is empty: give min x, min y, max x, max y"))
    }
}

/// The nearest integer if `side` is within a millionth of it, else `side`.
fn on_grid(side: f64) -> f64 {
    let nearest = side.round();
    if (side - nearest).abs() <= 1e-6 { nearest } else { side }
}

fn cell_region(tree: &CellTree, level: u8, column: u32, row: u32) -> Result<Region> {
    let cells = 1u64 << level.min(63);
    if level > tree.depth() || u64::from(column) >= cells || u64::from(row) >= cells {
        return Err(Error::usage(format!(
            "there is no cell {level}/{column}/{row}: the tree of the input has {} levels below its root",
            tree.depth()
        )));
    }
    let (min, max) = tree.corners(tree.encode(level, [column, row, 0]));
    Ok(Region { min: [min[0], min[1]], max: [max[0], max[1]] })
}

//! The part of the plane or of space that a run triangulates.

use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Region;
use spmesh_stream::model::cells::CellTree;
use spmesh_stream::{Coordinates, Header};

/// The part of the plane, or of space with `D = 3`, that a partial run triangulates. The run drops points
/// outside of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Part<const D: usize = 2> {
    /// A half-open box in world coordinates; sides may be infinite.
    Region(Region<D>),
    /// A half-open box in stored coordinates; sides may be infinite.
    Stored(Region<D>),
    /// A cell of the input's finalization tree.
    Cell {
        /// Level; the root has level 0.
        level: u8,
        /// Column, row, and in space layer, each below `2^level`.
        at: [u32; D],
    },
}

impl<const D: usize> Part<D> {
    /// The part as a half-open box in stored coordinates.
    pub(super) fn region(&self, header: &Header) -> Result<Region<D>> {
        match *self {
            Part::Region(region) => stored_region(&region, &header.coordinates),
            Part::Stored(region) => Ok(region),
            Part::Cell { level, at } => {
                let tree = header.tree.ok_or_else(|| {
                    Error::usage("the input has no finalization tree: give a region instead of a cell")
                })?;
                cell_region(&tree, level, at)
            }
        }
    }
}

/// A world box in stored coordinates. The map is monotone, so boxes that share a side still do. A side within
/// rounding of a grid point is snapped to it, so that the point lies on the border.
fn stored_region<const D: usize>(region: &Region<D>, coordinates: &Coordinates) -> Result<Region<D>> {
    let stored = |corner: [f64; D]| -> [f64; D] {
        match coordinates {
            Coordinates::F64 => corner,
            Coordinates::I32 { scale, offset } => {
                std::array::from_fn(|axis| on_grid((corner[axis] - offset[axis]) / scale[axis]))
            }
        }
    };
    let stored = Region { min: stored(region.min), max: stored(region.max) };
    if (0..D).all(|axis| stored.min[axis] < stored.max[axis]) {
        Ok(stored)
    } else {
        Err(Error::usage("the region is empty: give its least coordinates, then its greatest"))
    }
}

/// The nearest integer if `side` is within a millionth of it, else `side`.
fn on_grid(side: f64) -> f64 {
    let nearest = side.round();
    if (side - nearest).abs() <= 1e-6 { nearest } else { side }
}

/// The box of a cell of the tree.
fn cell_region<const D: usize>(tree: &CellTree, level: u8, at: [u32; D]) -> Result<Region<D>> {
    let cells = 1u64 << level.min(63);
    if level > tree.depth() || at.iter().any(|&place| u64::from(place) >= cells) {
        let name: String = at.iter().map(|place| format!("/{place}")).collect();
        return Err(Error::usage(format!(
            "there is no cell {level}{name}: the tree of the input has {} levels below its root",
            tree.depth()
        )));
    }
    let mut place = [0; 3];
    place[..D].copy_from_slice(&at);
    let (min, max) = tree.corners(tree.encode(level, place));
    Ok(Region::between(min, max))
}

//! The lowest point of each cell.

use bytemuck::{Pod, Zeroable};

use super::opening::GAP;
use crate::accumulators::Accumulators;
use crate::files::TilePlace;
use spmesh_base::error::{Error, Result};
use spmesh_formats::raster::TILE;
use spmesh_formats::source::PointReader;
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::{Bounds, Point};
use std::path::Path;

/// Steps of x and y in a cell, and of z in its unit.
pub(super) const STEPS: u32 = 256;
pub(super) const Z_STEPS: f64 = 1024.0;

/// A place so little below a border, in cells, is in the cell above: the same points on different grids of
/// coordinates differ by roundings, which must not move them to another cell.
const NUDGE: f64 = 1.0 / (1u64 << 20) as f64;

/// Tiles have numbers from 0 on; the one at the origin has this number.
const MIDDLE: i64 = 1 << 30;

/// Points that are put in order of their tiles when these do not fit memory.
const SORTED: usize = 1 << 18;

/// The lowest point of a cell: of equally low ones, that with the least x, then y.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Lowest {
    /// In steps of z; [`Lowest::NONE`] without a point.
    pub(super) z: i32,
    /// Steps from the lower left corner.
    pub(super) within: [u8; 2],
    /// What is known of the cell: see the constants of [`Lowest`].
    pub(super) marks: u16,
}

impl Lowest {
    const NONE: i32 = i32::MAX;
    const BLANK: Lowest = Lowest { z: Lowest::NONE, within: [0; 2], marks: 0 };
    /// Its point is noise: in a pit, or far from all others.
    pub(super) const NOISE: u16 = 1;
    /// It belongs to an object, by the first round, and by the second.
    pub(super) const OBJECT: [u16; 2] = [2, 4];

    /// Whether the cell has a point.
    pub(super) fn is_known(&self) -> bool {
        self.z != Lowest::NONE
    }

    /// Whether the cell has a point that is no noise.
    pub(super) fn is_sound(&self) -> bool {
        self.is_known() && self.marks & Lowest::NOISE == 0
    }

    /// z as a number for rasters. Exact up to 16,384 units.
    pub(super) fn height(&self) -> f32 {
        if self.is_known() { self.z as f32 } else { GAP }
    }
}

/// A point in steps.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed {
    /// The cell, counted from the origin of the world.
    pub(super) cell: [i32; 2],
    pub(super) within: [u8; 2],
    pub(super) z: i32,
}

/// Cells at multiples of a length, in world coordinates.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cells {
    pub(super) size: f64,
}

impl Cells {
    /// The cell of a place of the world.
    ///
    /// # Errors
    /// Usage, if the place is too far from the origin.
    pub(super) fn place(&self, world: Point) -> Result<Placed> {
        let too_far = || {
            let [x, y, z] = world;
            Error::usage(format!(
                "the point ({x:?}, {y:?}, {z:?}) is too far from the origin to find the ground there"
            ))
        };
        let at = [0, 1].map(|axis| world[axis] / self.size + NUDGE);
        let z = (world[2] * Z_STEPS).round();
        // Comparisons with NaN are false.
        let is_near = at.iter().all(|at| at.abs() < (1u32 << 30) as f64) && z.abs() < f64::from(i32::MAX);
        if !is_near {
            return Err(too_far());
        }
        let cell = at.map(f64::floor);
        let within = [0, 1].map(|axis| ((at[axis] - cell[axis]) * f64::from(STEPS)) as u8);
        Ok(Placed { cell: cell.map(|cell| cell as i32), within, z: z as i32 })
    }
}

/// The tile of a cell.
pub(super) fn tile_of(cell: [i32; 2]) -> TilePlace {
    cell.map(|cell| (i64::from(cell).div_euclid(TILE as i64) + MIDDLE) as usize)
}

/// The place of a cell in its tile.
pub(super) fn in_tile([x, y]: [i32; 2]) -> usize {
    let [x, y] = [x, y].map(|cell| i64::from(cell).rem_euclid(TILE as i64) as usize);
    y * TILE + x
}

/// The lower left cell of a tile.
pub(super) fn first_cell(tile: TilePlace) -> [i64; 2] {
    tile.map(|number| (number as i64 - MIDDLE) * TILE as i64)
}

/// A rectangle of cells.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent {
    /// The first and the last cell. They may be infinite.
    ends: [[f64; 2]; 2],
}

impl Extent {
    /// The cells of a box of the world, and of all places that are at most so far away.
    pub(super) fn around(window: &Bounds, halo: f64, size: f64) -> Extent {
        let ends = [(window.min, -halo), (window.max, halo)];
        Extent { ends: ends.map(|(end, halo)| [0, 1].map(|axis| ((end[axis] + halo) / size).floor())) }
    }

    fn contains(&self, cell: [i32; 2]) -> bool {
        let [first, last] = self.ends;
        (0..2).all(|axis| (first[axis]..=last[axis]).contains(&f64::from(cell[axis])))
    }
}

/// The lowest points of all cells.
pub(super) struct Lows {
    pub(super) tiles: Accumulators<Lowest>,
    pub(super) cells: Cells,
    /// Points in other cells do not count.
    extent: Option<Extent>,
}

impl Lows {
    /// No points. Points outside of `extent` will not count; `memory` is for tiles.
    ///
    /// # Errors
    /// Memory, if that is too little.
    pub(super) fn new(
        size: f64,
        extent: Option<Extent>,
        memory: u64,
        temp_dir: Option<&Path>,
    ) -> Result<Lows> {
        let tiles = Accumulators::anywhere(Lowest::BLANK, memory, temp_dir)?;
        Ok(Lows { tiles, cells: Cells { size }, extent })
    }

    /// Adds the points of a pass, and shows each batch to `also`, with the number of points so far; it says
    /// whether the next ones had better come in the order of tiles. Returns the number of points.
    ///
    /// # Errors
    /// Those of reading; usage, if a point is too far from the origin.
    pub(super) fn add(
        &mut self,
        reader: &mut dyn PointReader,
        coordinates: &Coordinates,
        mut also: impl FnMut(&[Placed], u64) -> Result<bool>,
    ) -> Result<u64> {
        let (mut batch, mut placed, mut points) = (Vec::new(), Vec::new(), 0);
        // As long as all tiles fit memory, the order of points does not matter.
        let mut is_sorted = false;
        loop {
            reader.next_batch(&mut batch)?;
            points += batch.len() as u64;
            for &stored in &batch {
                let point = self.cells.place(coordinates.to_world(stored))?;
                if self.extent.is_none_or(|extent| extent.contains(point.cell)) {
                    placed.push(point);
                }
            }
            if is_sorted && placed.len() < SORTED && !batch.is_empty() {
                continue;
            }
            if is_sorted {
                placed.sort_unstable_by_key(|placed: &Placed| tile_of(placed.cell));
            }
            for point in &placed {
                self.lower(point)?;
            }
            is_sorted = also(&placed, points)? || self.tiles.spilled > 0;
            placed.clear();
            if batch.is_empty() {
                return Ok(points);
            }
        }
    }

    #[inline]
    fn lower(&mut self, point: &Placed) -> Result<()> {
        let lowest = self.tiles.cell(tile_of(point.cell), in_tile(point.cell))?;
        if (point.z, point.within) < (lowest.z, lowest.within) {
            (lowest.z, lowest.within) = (point.z, point.within);
        }
        Ok(())
    }
}

/// The values of a rectangle of cells, row by row, from its lower left cell on; `blank` where no tile is.
///
/// # Errors
/// If reading tiles back fails.
pub(super) fn gather<C: Pod, V: Copy>(
    tiles: &mut Accumulators<C>,
    first: [i64; 2],
    [columns, rows]: [usize; 2],
    blank: V,
    value: impl Fn(&C) -> V,
) -> Result<Vec<V>> {
    let mut values = vec![blank; columns * rows];
    let side = TILE as i64;
    let ranges = [(first[0], columns), (first[1], rows)]
        .map(|(first, count)| first.div_euclid(side)..=(first + count as i64 - 1).div_euclid(side));
    for tile_y in ranges[1].clone() {
        for tile_x in ranges[0].clone() {
            let (corner, number) = ([tile_x * side, tile_y * side], [tile_x, tile_y]);
            if number.iter().any(|number| number + MIDDLE < 0) {
                continue;
            }
            let Some(cells) = tiles.read(number.map(|number| (number + MIDDLE) as usize))? else { continue };
            let [x, y] = [(0, columns), (1, rows)].map(|(axis, count)| {
                let start = (first[axis] - corner[axis]).max(0);
                start as usize..(first[axis] + count as i64 - corner[axis]).min(side) as usize
            });
            for row in y {
                let to = (corner[1] + row as i64 - first[1]) as usize * columns;
                let to = to + (corner[0] + x.start as i64 - first[0]) as usize;
                let from = &cells[row * TILE..][x.clone()];
                values[to..to + from.len()].iter_mut().zip(from).for_each(|(to, from)| *to = value(from));
            }
        }
    }
    Ok(values)
}

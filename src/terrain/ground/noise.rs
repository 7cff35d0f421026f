//! High noise: few points with nothing for a long way below them.

use std::path::Path;

use super::cells::{Placed, STEPS, Z_STEPS, first_cell, gather, in_tile, tile_of};
use crate::accumulators::Accumulators;
use crate::files::CELLS;
use spmesh_base::error::Result;
use spmesh_formats::raster::TILE;

/// Most points of a group that is noise.
const GROUP_MAX: usize = 3;

/// Side of a column, in metres.
pub(super) const COLUMN: f64 = 5.0;

/// The highest points of a column in steps of z, the highest first.
type Tops = [f32; GROUP_MAX + 1];

const NO_TOPS: Tops = [f32::NEG_INFINITY; GROUP_MAX + 1];

/// Columns: squares of a size.
#[derive(Debug, Clone, Copy)]
struct Squares {
    size: f64,
}

impl Squares {
    /// The column of a point whose cell is of size `cell`: that of its place in steps, which are never
    /// rounded differently.
    fn of(self, point: &Placed, cell: f64) -> [i32; 2] {
        [0, 1].map(|axis| {
            let place = f64::from(point.cell[axis]) + f64::from(point.within[axis]) / f64::from(STEPS);
            (place * (cell / self.size)).floor() as i32
        })
    }
}

/// The highest points of columns.
pub(super) struct Columns {
    tops: Accumulators<Tops>,
    squares: Squares,
    gap: f32,
}

impl Columns {
    /// No points. `gap` is the way below noise without a point.
    ///
    /// # Errors
    /// Memory, if there is too little for tiles.
    pub(super) fn new(size: f64, gap: f64, memory: u64, temp_dir: Option<&Path>) -> Result<Columns> {
        let tops = Accumulators::anywhere(NO_TOPS, memory, temp_dir)?;
        Ok(Columns { tops, squares: Squares { size }, gap: (gap * Z_STEPS) as f32 })
    }

    /// Adds points, whose cells are of size `cell`. Returns whether tiles do not fit memory, so that points
    /// had better come in the order of tiles.
    ///
    /// # Errors
    /// If the temporary file fails.
    pub(super) fn add(&mut self, points: &[Placed], cell: f64) -> Result<bool> {
        for point in points {
            let column = self.squares.of(point, cell);
            let tops = self.tops.cell(tile_of(column), in_tile(column))?;
            put(tops, point.z as f32);
        }
        Ok(self.tops.spilled > 0)
    }

    /// From which z on points of each column are noise.
    ///
    /// # Errors
    /// If the temporary file fails, or memory is too little for tiles.
    pub(super) fn limits(mut self, memory: u64, temp_dir: Option<&Path>) -> Result<NoiseLimits> {
        let mut limits = Accumulators::anywhere(f32::INFINITY, memory, temp_dir)?;
        for tile in self.tops.tiles() {
            let first = first_cell(tile).map(|cell| cell - 1);
            let side = TILE + 2;
            let tops = gather(&mut self.tops, first, [side; 2], NO_TOPS, |tops| *tops)?;
            for at in 0..CELLS {
                let [x, y] = [at % TILE, at / TILE];
                let around = (y..y + 3).flat_map(|row| &tops[row * side + x..row * side + x + 3]);
                if let Some(limit) = limit(around, self.gap) {
                    *limits.cell(tile, at)? = limit;
                }
            }
        }
        Ok(NoiseLimits { limits, squares: self.squares })
    }
}

/// Puts a z among the highest.
fn put(tops: &mut Tops, z: f32) {
    if z > tops[GROUP_MAX] {
        let at = tops.partition_point(|&top| top >= z);
        tops.copy_within(at..GROUP_MAX, at + 1);
        tops[at] = z;
    }
}

/// The lowest z of the group above the gap: the largest group of few points above one that has points below.
fn limit<'t>(around: impl Iterator<Item = &'t Tops>, gap: f32) -> Option<f32> {
    let mut highest = NO_TOPS;
    around.for_each(|tops| tops.iter().for_each(|&z| put(&mut highest, z)));
    let is_above = |pair: &[f32]| pair[1] > f32::NEG_INFINITY && pair[0] - pair[1] >= gap;
    highest.windows(2).rev().find(|pair| is_above(pair)).map(|pair| pair[0])
}

/// From which z on points of each column are noise.
pub(super) struct NoiseLimits {
    limits: Accumulators<f32>,
    squares: Squares,
}

impl NoiseLimits {
    /// Whether a point is noise; its cell is of size `cell`.
    ///
    /// # Errors
    /// If the temporary file fails.
    pub(super) fn is_noise(&mut self, point: &Placed, cell: f64) -> Result<bool> {
        let column = self.squares.of(point, cell);
        // Not read: the tile is mostly that of the last point, which is found faster like this.
        Ok(point.z as f32 >= *self.limits.cell(tile_of(column), in_tile(column))?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_points_above_a_gap_are_noise() {
        let tops = |z: &[f32]| {
            let mut tops = NO_TOPS;
            z.iter().for_each(|&z| put(&mut tops, z));
            tops
        };
        let limit_of = |columns: &[&[f32]]| {
            let columns: Vec<Tops> = columns.iter().map(|z| tops(z)).collect();
            limit(columns.iter(), 15.0)
        };
        assert_eq!(limit_of(&[&[1.0, 80.0, 2.0], &[3.0]]), Some(80.0));
        assert_eq!(limit_of(&[&[1.0, 80.0], &[78.0, 82.0, 5.0]]), Some(78.0));
        // Four are no noise, nor are points with nothing below.
        assert_eq!(limit_of(&[&[1.0, 80.0, 79.0], &[78.0, 82.0, 5.0]]), None);
        assert_eq!(limit_of(&[&[80.0, 81.0]]), None);
        assert_eq!(limit_of(&[&[1.0, 10.0, 20.0]]), None);
    }
}

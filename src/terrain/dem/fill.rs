//! Fills cells without data from data around them.

use crate::files::TilePlace;
use spmesh_base::error::{Error, Result};
use spmesh_formats::raster::TILE;

/// The greatest reach. It keeps the data for a tile within the adjacent tiles.
pub(super) const REACH_MAX: u32 = TILE as u32;

/// Fills cells of a tile from the nearest data in eight directions within a reach, weighted by inverse
/// distance.
///
/// Filled cells do not count as data for others, so that the order of tiles does not matter.
pub(super) struct Filler {
    reach: usize,
    /// Cells along a side of the window: a tile, and a margin of the reach.
    side: usize,
    window: Vec<f32>,
    neighbor: Vec<f32>,
    /// For cells of the tile, sums of weighted values and of weights.
    sums: Vec<[f64; 2]>,
}

/// The nearest data in a direction, for the cells of a row.
#[derive(Clone, Copy)]
struct Seen {
    value: f32,
    /// The number of steps to it.
    steps: u32,
}

const NOTHING: Seen = Seen { value: f32::NAN, steps: 0 };

impl Filler {
    /// A filler with a reach in cells.
    pub(super) fn new(reach: u32) -> Result<Filler> {
        if !(1..=REACH_MAX).contains(&reach) {
            return Err(Error::usage(format!(
                "cells can be filled from 1 to {REACH_MAX} cells away, not from {reach}"
            )));
        }
        let reach = reach as usize;
        let side = TILE + 2 * reach;
        Ok(Filler {
            reach,
            side,
            window: vec![f32::NAN; side * side],
            neighbor: vec![f32::NAN; TILE * TILE],
            sums: vec![[0.0; 2]; TILE * TILE],
        })
    }

    /// Fills cells of a tile; `read` reads tiles as drawn, and returns false for blank ones. Returns false if
    /// no data are near.
    pub(super) fn fill(
        &mut self,
        [column, row]: TilePlace,
        tiles: [usize; 2],
        mut read: impl FnMut(TilePlace, &mut [f32]) -> Result<bool>,
        values: &mut [f32],
    ) -> Result<bool> {
        self.window.fill(f32::NAN);
        let mut has_data = false;
        for [x, y] in around([column, row], tiles) {
            if read([x, y], &mut self.neighbor)? {
                has_data = true;
                self.place([x + 1 - column, y + 1 - row]);
            }
        }
        if has_data {
            self.interpolate(values);
        }
        Ok(has_data)
    }

    /// Copies the part of a tile within reach into the window; `at` is 1, 1 for the tile to fill.
    fn place(&mut self, at: [usize; 2]) {
        // The first cell in the neighbour, its place in the window, and the number of cells.
        let part = |at: usize| match at {
            0 => (TILE - self.reach, 0, self.reach),
            1 => (0, self.reach, TILE),
            _ => (0, self.reach + TILE, self.reach),
        };
        let [(from_column, column, width), (from_row, row, height)] = at.map(part);
        for line in 0..height {
            let from = &self.neighbor[(from_row + line) * TILE + from_column..][..width];
            self.window[(row + line) * self.side + column..][..width].copy_from_slice(from);
        }
    }

    fn interpolate(&mut self, values: &mut [f32]) {
        self.sums.fill([0.0; 2]);
        self.sweep();
        // The other four directions are the first four in the window rotated by 180 degrees.
        self.window.reverse();
        self.sums.reverse();
        self.sweep();
        self.window.reverse();
        self.sums.reverse();
        for (line, row) in values.chunks_exact_mut(TILE).enumerate() {
            let known = &self.window[(line + self.reach) * self.side + self.reach..][..TILE];
            for ((value, known), [sum, weight]) in row.iter_mut().zip(known).zip(&self.sums[line * TILE..]) {
                *value = if known.is_nan() { (sum / weight) as f32 } else { *known };
            }
        }
    }

    /// Adds the nearest data to the left of each cell, and in three directions above it.
    fn sweep(&mut self) {
        let side = self.side;
        let mut above = [vec![NOTHING; side], vec![NOTHING; side], vec![NOTHING; side]];
        let mut next = above.clone();
        for (line, row) in self.window.chunks_exact(side).enumerate() {
            let mut left = NOTHING;
            for (column, &value) in row.iter().enumerate() {
                let upper = |shift: usize, seen: &[Seen]| {
                    // Shifts 0, 1 and 2 are above on the left, above, and above on the right.
                    (column + shift).checked_sub(1).and_then(|at| seen.get(at)).copied().unwrap_or(NOTHING)
                };
                let seen = [left, upper(0, &above[0]), upper(1, &above[1]), upper(2, &above[2])];
                let is_inside = |at: usize| (self.reach..self.reach + TILE).contains(&at);
                if value.is_nan() && is_inside(line) && is_inside(column) {
                    let cell = (line - self.reach) * TILE + column - self.reach;
                    let lengths = [1.0, std::f64::consts::SQRT_2, 1.0, std::f64::consts::SQRT_2];
                    for (seen, length) in seen.iter().zip(lengths) {
                        add(&mut self.sums[cell], *seen, length, self.reach);
                    }
                }
                let step = |seen: Seen| {
                    let steps = if value.is_nan() { seen.steps + 1 } else { 1 };
                    Seen { value: if value.is_nan() { seen.value } else { value }, steps }
                };
                left = step(seen[0]);
                (0..3).for_each(|direction| next[direction][column] = step(seen[direction + 1]));
            }
            std::mem::swap(&mut above, &mut next);
        }
    }
}

/// A tile and its neighbours in a grid of `tiles[0]` by `tiles[1]` tiles.
pub(super) fn around([column, row]: TilePlace, tiles: [usize; 2]) -> impl Iterator<Item = TilePlace> {
    let columns = column.saturating_sub(1)..(column + 2).min(tiles[0]);
    let rows = row.saturating_sub(1)..(row + 2).min(tiles[1]);
    rows.flat_map(move |y| columns.clone().map(move |x| [x, y]))
}

/// Adds the nearest data of one direction, if they are within reach.
fn add([sum, weights]: &mut [f64; 2], seen: Seen, length: f64, reach: usize) {
    let distance = f64::from(seen.steps) * length;
    if !seen.value.is_nan() && distance <= reach as f64 {
        *sum += f64::from(seen.value) / distance;
        *weights += 1.0 / distance;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_base::random::Random;

    /// Cells of three by three tiles.
    const SIDE: usize = 3 * TILE;

    /// The value that fills a cell, found step by step.
    fn slow(image: &[f32], at: [usize; 2], reach: u32) -> f64 {
        let (mut sum, mut weights) = (0.0, 0.0);
        for [dx, dy] in [[-1, -1], [0, -1], [1, -1], [-1, 0], [1, 0], [-1, 1], [0, 1], [1, 1]] {
            let cell = |step: i64| {
                let [x, y] = [at[0] as i64 + dx * step, at[1] as i64 + dy * step];
                let is_inside = [x, y].iter().all(|place| (0..SIDE as i64).contains(place));
                is_inside.then(|| image[y as usize * SIDE + x as usize])
            };
            let length = ((dx * dx + dy * dy) as f64).sqrt();
            let steps = (1..).take_while(|&step| step as f64 * length <= f64::from(reach));
            let found =
                steps.map(|step| (step, cell(step))).find(|(_, value)| value.is_none_or(|v| !v.is_nan()));
            if let Some((step, Some(value))) = found {
                sum += f64::from(value) / (step as f64 * length);
                weights += 1.0 / (step as f64 * length);
            }
        }
        sum / weights
    }

    #[test]
    fn each_cell_has_what_it_sees() {
        let mut random = Random::new(5);
        let image: Vec<f32> = (0..SIDE * SIDE)
            .map(|_| if random.below(50) == 0 { random.below(1_000) as f32 } else { f32::NAN })
            .collect();
        for reach in [1, 7, 256] {
            let read = |[x, y]: TilePlace, tile: &mut [f32]| {
                for (line, row) in tile.chunks_exact_mut(TILE).enumerate() {
                    row.copy_from_slice(&image[(y * TILE + line) * SIDE + x * TILE..][..TILE]);
                }
                Ok([x, y] != [2, 0])
            };
            let mut image = image.clone();
            for line in image.chunks_exact_mut(SIDE).take(TILE) {
                line[2 * TILE..].fill(f32::NAN);
            }
            let mut values = vec![0.0; TILE * TILE];
            assert!(Filler::new(reach).unwrap().fill([1, 1], [3, 3], read, &mut values).unwrap());
            for (cell, value) in values.iter().enumerate() {
                let at = [TILE + cell % TILE, TILE + cell / TILE];
                let known = image[at[1] * SIDE + at[0]];
                let expected = if known.is_nan() { slow(&image, at, reach) as f32 } else { known };
                assert!(
                    value.to_bits() == expected.to_bits() || (value - expected).abs() < 1e-3,
                    "{at:?}: {value}, expected {expected}"
                );
            }
        }
    }

    #[test]
    fn far_or_no_data_fill_nothing() {
        assert!(Filler::new(0).is_err() && Filler::new(REACH_MAX + 1).is_err());
        let mut values = vec![f32::NAN; TILE * TILE];
        let nothing = |_: TilePlace, _: &mut [f32]| Ok(false);
        assert!(!Filler::new(9).unwrap().fill([0, 0], [1, 1], nothing, &mut values).unwrap());
        assert!(values.iter().all(|value| value.is_nan()));
    }
}

//! Writes the remaining tiles after the last triangle.

use super::fill::{Filler, around};
use super::tile_cache::{TileCache, TilePlace};
use spmesh_core::error::Result;
use spmesh_io::raster::TILE;

/// The number of cells with a value.
pub(super) fn count_known(values: &[f32]) -> u64 {
    values.iter().filter(|value| !value.is_nan()).count() as u64
}

/// Reads the values of a tile; returns false for a blank tile.
pub(super) type ReadTile<'a> = dyn FnMut(TilePlace, &mut [f32]) -> Result<bool> + 'a;

/// The final pass over the tiles, which fills holes.
pub(super) struct Flush<'a> {
    cache: &'a mut TileCache,
    filler: Option<Filler>,
    /// Number of filled cells.
    pub(super) filled: u64,
}

impl<'a> Flush<'a> {
    pub(super) fn new(cache: &'a mut TileCache, filler: Option<Filler>) -> Flush<'a> {
        Flush { cache, filler, filled: 0 }
    }

    /// Reads the final values of a tile; returns false for a blank tile. `read_written` reads tiles that were
    /// written.
    ///
    /// # Errors
    /// Those of `read_written`; if the temporary file fails.
    pub(super) fn tile(
        &mut self,
        at: TilePlace,
        read_written: &mut ReadTile,
        values: &mut [f32],
    ) -> Result<bool> {
        let (tiles, inside) = (self.cache.tiles(), self.cache.inside(at));
        if around(at, tiles).all(|near| self.cache.is_blank(near)) {
            return Ok(false);
        }
        let mut read = |at: TilePlace, values: &mut [f32]| {
            if self.cache.is_written(at) { read_written(at, values) } else { self.cache.read(at, values) }
        };
        let has_data = read(at, values)?;
        let Some(filler) = &mut self.filler else { return Ok(has_data) };
        let drawn = if has_data { count_known(values) } else { 0 };
        if !filler.fill(at, tiles, read, values)? {
            return Ok(false);
        }
        blank_beyond(inside, values);
        let known = count_known(values);
        self.filled += known - drawn;
        Ok(known > 0)
    }

    /// Calls `take` with the tiles that were not written, row by row, except blank ones.
    ///
    /// # Errors
    /// Those of `take` and of [`Flush::tile`].
    pub(super) fn write_rest<T>(
        &mut self,
        target: &mut T,
        mut read: impl FnMut(&mut T, TilePlace, &mut [f32]) -> Result<bool>,
        mut take: impl FnMut(&mut T, TilePlace, &[f32]) -> Result<()>,
    ) -> Result<()> {
        let [across, down] = self.cache.tiles();
        let mut values = vec![f32::NAN; TILE * TILE];
        for at in (0..down).flat_map(|row| (0..across).map(move |column| [column, row])) {
            let is_left = !self.cache.is_written(at);
            if is_left && self.tile(at, &mut |at, values| read(target, at, values), &mut values)? {
                take(target, at, &values)?;
            }
        }
        Ok(())
    }

    /// Reads a row of tiles as rows of cells. None of them may have been written.
    ///
    /// # Errors
    /// If the temporary file fails.
    pub(super) fn band(&mut self, row: usize, band: &mut [f32]) -> Result<()> {
        let [across, _] = self.cache.tiles();
        let mut values = vec![f32::NAN; TILE * TILE];
        for column in 0..across {
            if !self.tile([column, row], &mut |_, _| Ok(false), &mut values)? {
                values.fill(f32::NAN);
            }
            for (into, from) in band.chunks_exact_mut(across * TILE).zip(values.chunks_exact(TILE)) {
                into[column * TILE..][..TILE].copy_from_slice(from);
            }
        }
        Ok(())
    }
}

/// Blanks the cells beyond the grid, given the numbers of columns and rows inside it.
fn blank_beyond([columns, rows]: [usize; 2], values: &mut [f32]) {
    for (number, row) in values.chunks_exact_mut(TILE).enumerate() {
        let kept = if number < rows { columns } else { 0 };
        row[kept..].fill(f32::NAN);
    }
}

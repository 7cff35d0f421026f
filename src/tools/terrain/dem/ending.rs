//! What tiles have when all triangles are drawn.

use super::canvas::{Canvas, TilePlace};
use super::fill::{Filler, around};
use spmesh_core::error::Result;
use spmesh_io::raster::TILE;

/// Number of cells with a value.
pub(super) fn count_known(values: &[f32]) -> u64 {
    values.iter().filter(|value| !value.is_nan()).count() as u64
}

/// Reads the values of a tile; false, if nothing is known of it.
pub(super) type ReadTile<'a> = dyn FnMut(TilePlace, &mut [f32]) -> Result<bool> + 'a;

/// Tiles after the last triangle.
pub(super) struct Ending<'a> {
    canvas: &'a mut Canvas,
    filler: Option<Filler>,
    /// Number of cells that were filled.
    pub(super) filled: u64,
}

impl<'a> Ending<'a> {
    pub(super) fn new(canvas: &'a mut Canvas, filler: Option<Filler>) -> Ending<'a> {
        Ending { canvas, filler, filled: 0 }
    }

    /// The values of the tile at a place; false, if nothing is known of it. `handed_on` reads those that were handed on.
    ///
    /// # Errors
    /// Those of `handed_on`; if the temporary file fails.
    pub(super) fn tile(
        &mut self,
        at: TilePlace,
        handed_on: &mut ReadTile,
        values: &mut [f32],
    ) -> Result<bool> {
        let (tiles, inside) = (self.canvas.tiles(), self.canvas.inside(at));
        if around(at, tiles).all(|near| self.canvas.is_blank(near)) {
            return Ok(false);
        }
        let mut read = |at: TilePlace, values: &mut [f32]| {
            if self.canvas.is_handed_on(at) { handed_on(at, values) } else { self.canvas.read(at, values) }
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

    /// Calls `take` with the tiles that were not handed on, in rows, but for those of which nothing is known.
    ///
    /// # Errors
    /// Those of `take` and of [`Ending::tile`].
    pub(super) fn hand_over<T>(
        &mut self,
        target: &mut T,
        mut read: impl FnMut(&mut T, TilePlace, &mut [f32]) -> Result<bool>,
        mut take: impl FnMut(&mut T, TilePlace, &[f32]) -> Result<()>,
    ) -> Result<()> {
        let [across, down] = self.canvas.tiles();
        let mut values = vec![f32::NAN; TILE * TILE];
        for at in (0..down).flat_map(|row| (0..across).map(move |column| [column, row])) {
            let is_left = !self.canvas.is_handed_on(at);
            if is_left && self.tile(at, &mut |at, values| read(target, at, values), &mut values)? {
                take(target, at, &values)?;
            }
        }
        Ok(())
    }

    /// Reads a row of tiles as rows of cells, of which none were handed on.
    ///
    /// # Errors
    /// If the temporary file fails.
    pub(super) fn band(&mut self, row: usize, band: &mut [f32]) -> Result<()> {
        let [across, _] = self.canvas.tiles();
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

/// Takes away what was filled beyond the grid; `inside` are the numbers of columns and rows that are in it.
fn blank_beyond([columns, rows]: [usize; 2], values: &mut [f32]) {
    for (number, row) in values.chunks_exact_mut(TILE).enumerate() {
        let kept = if number < rows { columns } else { 0 };
        row[kept..].fill(f32::NAN);
    }
}

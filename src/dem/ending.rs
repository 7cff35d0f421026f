//! What is written when all triangles are drawn.

use std::io::{Seek, Write};

use super::canvas::Canvas;
use super::painter::Handover;
use super::tile::Tile;
use crate::error::Result;
use crate::raster::{self, Grid, RasterFormat, TILE};
use crate::stream::Crs;

/// Number of cells with a value.
pub(super) fn count_known(values: &[f32]) -> u64 {
    values.iter().filter(|value| !value.is_nan()).count() as u64
}

/// Hands over all tiles that are not complete, but for blank ones.
///
/// # Errors
/// Those of `take`; if the temporary file fails.
pub(super) fn hand_over(canvas: &mut Canvas, take: &mut Handover) -> Result<()> {
    let [across, down] = canvas.tiles();
    let mut tile = Tile::new();
    for at in (0..down).flat_map(|row| (0..across).map(move |column| [column, row])) {
        if canvas.read(at, &mut tile)? {
            take(at, &tile.values)?;
        }
    }
    Ok(())
}

/// Writes all tiles row by row; the number of cells with a value.
///
/// Memory: one row of tiles.
///
/// # Errors
/// If writing or the temporary file fails.
pub(super) fn write_rows<W: Write + Seek>(
    canvas: &mut Canvas,
    output: &mut W,
    format: RasterFormat,
    grid: &Grid,
    crs: &Crs,
) -> Result<u64> {
    let width = canvas.tiles()[0] * TILE;
    let (mut band, mut tile, mut known) = (vec![f32::NAN; width * TILE], Tile::new(), 0);
    raster::write_rows(output, format, grid, crs, |row, values| {
        let row = row as usize;
        if row.is_multiple_of(TILE) {
            read_band(canvas, row / TILE, &mut tile, &mut band)?;
        }
        values.copy_from_slice(&band[row % TILE * width..][..values.len()]);
        known += count_known(values);
        Ok(())
    })?;
    Ok(known)
}

/// Reads a row of tiles.
fn read_band(canvas: &mut Canvas, row: usize, tile: &mut Tile, band: &mut [f32]) -> Result<()> {
    let [across, _] = canvas.tiles();
    for column in 0..across {
        if !canvas.read([column, row], tile)? {
            tile.clear();
        }
        for (into, from) in band.chunks_exact_mut(across * TILE).zip(tile.values.chunks_exact(TILE)) {
            into[column * TILE..][..TILE].copy_from_slice(from);
        }
    }
    Ok(())
}

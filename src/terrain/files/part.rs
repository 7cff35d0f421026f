//! A part of a raster as a raster of its own.

use std::io::{Seek, Write};
use std::ops::Range;

use super::tiles::{CELLS, TilePlace, TileSource, places, tiles_of};
use spmesh_base::error::Result;
use spmesh_formats::raster::{self, Grid, RasterFile, RasterFormat, TILE};

/// One row of tiles, as rows of cells.
///
/// Memory: 256 rows.
struct Band {
    /// Tiles in a row.
    across: usize,
    /// The row of tiles that is there.
    at: Option<usize>,
    values: Vec<f32>,
    tile: Vec<f32>,
}

impl Band {
    /// No tiles so far.
    fn new(grid: Grid) -> Band {
        let across = (grid.columns as usize).div_ceil(TILE);
        Band { across, at: None, values: vec![f32::NAN; across * CELLS], tile: vec![f32::NAN; CELLS] }
    }

    /// Reads a row of cells; NaN marks those without data.
    fn read(&mut self, tiles: &mut dyn TileSource, row: u32, values: &mut [f32]) -> Result<()> {
        let (row, width) = (row as usize, self.across * TILE);
        if self.at != Some(row / TILE) {
            for column in 0..self.across {
                if !tiles.get([column, row / TILE], &mut self.tile)? {
                    self.tile.fill(f32::NAN);
                }
                for (into, from) in self.values.chunks_exact_mut(width).zip(self.tile.chunks_exact(TILE)) {
                    into[column * TILE..][..TILE].copy_from_slice(from);
                }
            }
            self.at = Some(row / TILE);
        }
        values.copy_from_slice(&self.values[row % TILE * width..][..values.len()]);
        Ok(())
    }
}

/// A rectangle of cells of the tiles of a source, in tiles of its own.
///
/// Memory: one tile.
pub(super) struct Part<'s> {
    source: &'s mut dyn TileSource,
    /// Columns and rows of the source.
    cells: [Range<i64>; 2],
    /// Those of them that are part of the raster; others have no data.
    raster: [Range<u32>; 2],
    bands: usize,
    tile: Vec<f32>,
    /// Whether tiles that were read have data.
    pub(super) has_data: bool,
}

impl<'s> Part<'s> {
    /// The cells in these columns and rows of a source, which has data for those of `raster`.
    pub(super) fn new(
        source: &'s mut dyn TileSource,
        cells: [Range<i64>; 2],
        raster: [Range<u32>; 2],
        bands: usize,
    ) -> Part<'s> {
        Part { source, cells, raster, bands, tile: vec![f32::NAN; bands * CELLS], has_data: false }
    }
}

impl TileSource for Part<'_> {
    fn get(&mut self, at: TilePlace, values: &mut [f32]) -> Result<bool> {
        // Columns and rows of the source that the tile covers, and those of them that have data.
        let first = [0, 1].map(|axis| self.cells[axis].start + (at[axis] * TILE) as i64);
        let window = [0, 1].map(|axis| {
            let Range { start, end } = self.raster[axis];
            let last = (first[axis] + TILE as i64).min(self.cells[axis].end).min(end.into()).max(0);
            let start = first[axis].max(start.into());
            start as usize..(last as usize).max(start as usize)
        });
        let [columns, rows] = window.clone().map(|cells| match cells.is_empty() {
            true => 0..0,
            false => cells.start / TILE..cells.end.div_ceil(TILE),
        });
        values.fill(f32::NAN);
        let mut has_data = false;
        for from in rows.flat_map(|row| columns.clone().map(move |column| [column, row])) {
            if self.source.get(from, &mut self.tile)? {
                has_data |= copy(&self.tile, from, &window, first, values, self.bands);
            }
        }
        self.has_data |= has_data;
        Ok(has_data)
    }
}

/// Copies what a tile has of a window to values whose first cell is `first`; returns whether that has data.
fn copy(
    tile: &[f32],
    at: TilePlace,
    window: &[Range<usize>; 2],
    first: [i64; 2],
    values: &mut [f32],
    bands: usize,
) -> bool {
    let [columns, rows] = [0, 1]
        .map(|axis| window[axis].start.max(at[axis] * TILE)..window[axis].end.min((at[axis] + 1) * TILE));
    let mut has_data = false;
    for band in 0..bands {
        for row in rows.clone() {
            let place = |first: [i64; 2]| {
                let [column, row] = [columns.start as i64 - first[0], row as i64 - first[1]];
                band * CELLS + row as usize * TILE + column as usize
            };
            let from = &tile[place(at.map(|at| (at * TILE) as i64))..][..columns.len()];
            has_data |= from.iter().any(|value| !value.is_nan());
            values[place(first)..][..columns.len()].copy_from_slice(from);
        }
    }
    has_data
}

/// Writes a raster file from tiles.
pub(super) fn write<W: Write + Seek>(
    output: &mut W,
    file: &RasterFile,
    source: &mut dyn TileSource,
) -> Result<()> {
    match file.options.format {
        // Rows are written from the top, so all tiles must have come.
        RasterFormat::Ascii => {
            let mut band = Band::new(file.grid);
            raster::write_rows(output, file, |row, values| band.read(source, row, values))
        }
        RasterFormat::GeoTiff => raster::write_tiles(output, file, |tiles| {
            let mut values = vec![f32::NAN; file.samples.bands() * CELLS];
            for at in places(tiles_of(&file.grid)?) {
                if source.get(at, &mut values)? {
                    tiles.tile(at[0], at[1], &values)?;
                }
            }
            Ok(())
        }),
    }
}

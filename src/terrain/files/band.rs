//! Rows of cells from tiles.

use super::tiles::{CELLS, TileSource};
use spmesh_base::error::Result;
use spmesh_formats::raster::{Grid, TILE};

/// One row of tiles, as rows of cells.
///
/// Memory: 256 rows.
pub(super) struct Band {
    /// Tiles in a row.
    across: usize,
    /// The row of tiles that is there.
    at: Option<usize>,
    values: Vec<f32>,
    tile: Vec<f32>,
}

impl Band {
    /// No tiles so far.
    pub(super) fn new(grid: Grid) -> Band {
        let across = (grid.columns as usize).div_ceil(TILE);
        Band { across, at: None, values: vec![f32::NAN; across * CELLS], tile: vec![f32::NAN; CELLS] }
    }

    /// Reads a row of cells; NaN marks those without data.
    pub(super) fn read(&mut self, tiles: &mut dyn TileSource, row: u32, values: &mut [f32]) -> Result<()> {
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

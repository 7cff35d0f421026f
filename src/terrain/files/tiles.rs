//! The tiles that a raster is made of: blocks of cells that are passed on as a whole.

use spmesh_base::error::{Error, Result};
use spmesh_base::limits::RASTER_TILES_MAX;
use spmesh_formats::raster::{Grid, TILE, Tiles};

/// Number of cells of a tile, including those beyond the grid.
pub(crate) const CELLS: usize = TILE * TILE;

/// The column and the row of a tile, from the top left.
pub(crate) type TilePlace = [usize; 2];

/// Gives tiles back.
pub(crate) trait TileSource {
    /// Reads the values of a tile, band by band; NaN marks cells without data. Returns false if there is no
    /// such tile.
    fn get(&mut self, at: TilePlace, values: &mut [f32]) -> Result<bool>;
}

/// Takes complete tiles in any order, each once, and gives them back.
pub(crate) trait TileTarget: TileSource {
    /// Takes the values of a tile, band by band; NaN marks cells without data.
    fn put(&mut self, at: TilePlace, values: &[f32]) -> Result<()>;

    /// Takes note of a tile without any data. A tile that never comes has none either.
    fn skip(&mut self, _at: TilePlace) -> Result<()> {
        Ok(())
    }
}

/// A staged GeoTIFF can give tiles back, others cannot.
impl TileSource for Tiles<'_> {
    fn get(&mut self, [column, row]: TilePlace, values: &mut [f32]) -> Result<bool> {
        self.read(column, row, values)
    }
}

impl TileTarget for Tiles<'_> {
    fn put(&mut self, [column, row]: TilePlace, values: &[f32]) -> Result<()> {
        self.tile(column, row, values)
    }
}

/// The number of tiles in a row of a grid, and in a column.
pub(crate) fn tiles_of(grid: &Grid) -> Result<[usize; 2]> {
    let [across, down] = [grid.columns, grid.rows].map(|count| (count as usize).div_ceil(TILE));
    let count = across as u64 * down as u64;
    if count <= RASTER_TILES_MAX {
        return Ok([across, down]);
    }
    Err(Error::usage(format!(
        "{} by {} cells of size {} are {count} tiles, at most {RASTER_TILES_MAX} are possible: take larger cells, \
         or a part with --bounds",
        grid.columns, grid.rows, grid.step
    )))
}

/// All places of a grid of tiles, row by row.
pub(crate) fn places([across, down]: [usize; 2]) -> impl Iterator<Item = TilePlace> {
    (0..down).flat_map(move |row| (0..across).map(move |column| [column, row]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_have_a_limit() {
        let side = (RASTER_TILES_MAX as f64).sqrt() as usize;
        let tiles = |columns: usize| {
            let [columns, rows] = [columns, side * TILE].map(|count| count as u32);
            tiles_of(&Grid { left: 0.0, top: 0.0, step: 1.0, columns, rows })
        };
        assert_eq!(tiles(side * TILE).unwrap(), [side, side]);
        let message = tiles(side * TILE + 1).unwrap_err().to_string();
        assert!(message.contains("are 4196352 tiles, at most 4194304"), "{message}");
    }
}

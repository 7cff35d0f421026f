//! Rasters: values in cells of a grid, row by row from the top, and files of them.
//!
//! `grid` says where cells are, `geotiff` and `ascii` write files; `relief` has what is made of gradients.

mod ascii;
mod geo_keys;
mod geotiff;
mod grid;
mod relief;

use std::io::{Seek, Write};

pub use geotiff::{TILE, Tiles, write_tiles};
pub use grid::{Cells, Grid, Window};
pub use relief::{Light, aspect, slope};

use crate::error::Result;
use crate::stream::Crs;

/// The value of cells where nothing is known.
pub const NO_DATA: f32 = -9999.0;

/// Formats of files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RasterFormat {
    /// Tiles of 256 by 256 cells, compressed; BigTIFF if it may be longer than 4 GiB.
    GeoTiff,
    /// Text of ESRI, with as many digits as tell numbers of 32 bits apart.
    Ascii,
}

/// Writes a file: `row` is asked for the values of each row, from the top; NaN is a cell where nothing is known.
///
/// Memory: 256 rows.
///
/// # Errors
/// Those of `row`; if writing fails.
pub fn write_rows<W: Write + Seek>(
    output: &mut W,
    format: RasterFormat,
    grid: &Grid,
    crs: &Crs,
    mut row: impl FnMut(u32, &mut [f32]) -> Result<()>,
) -> Result<()> {
    match format {
        RasterFormat::Ascii => ascii::write_rows(output, grid, row),
        RasterFormat::GeoTiff => write_tiles(output, grid, crs, |tiles| tiles.rows(&mut row)),
    }
}

//! Rasters: values in cells of a grid, row by row from the top, and files of them.
//!
//! `grid` says where cells are, and `like` where those of a file are; `geotiff` and `ascii` write files, with
//! a number of `no_data`; `relief` has what is made of gradients.

mod ascii;
mod geotiff;
mod grid;
mod like;
mod no_data;
mod relief;

use std::io::{Seek, Write};
use std::path::PathBuf;

pub use geotiff::{Reduction, TILE, Tiles, write_tiles};
pub use grid::{Cells, Grid, Window};
pub use no_data::NoData;
pub use relief::{Light, aspect, slope};

use spmesh_core::error::Result;
use spmesh_stream::Crs;

/// Formats of files.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum RasterFormat {
    /// Tiles of 256 by 256 cells, compressed; BigTIFF if it may be longer than 4 GiB.
    #[default]
    GeoTiff,
    /// Text of ESRI, with as many digits as tell f32 values apart.
    Ascii,
}

/// How files are written.
#[derive(Debug, Clone, Default)]
pub struct RasterOptions {
    /// Their format.
    pub format: RasterFormat,
    /// What cells have where nothing is known.
    pub no_data: NoData,
    /// Whether a GeoTIFF has overviews, and is laid out for readers at the other end of a network: overviews
    /// stand before the image, and tiles in rows.
    pub has_overviews: bool,
    /// Where temporary files go; the system's folder for these if `None`.
    pub temp_dir: Option<PathBuf>,
}

/// What file a raster becomes.
#[derive(Debug, Clone, Copy)]
pub struct RasterFile<'a> {
    /// How it is written.
    pub options: &'a RasterOptions,
    /// Its cells.
    pub grid: Grid,
    /// Where on the earth these are.
    pub crs: &'a Crs,
    /// Whether cells have elevations, which the system may say the unit of.
    pub are_elevations: bool,
    /// How overviews are made.
    pub reduction: Reduction,
    /// Tiles wait in a temporary file until all have come, as they do for overviews, and for outputs that
    /// cannot be sought: they can be read again.
    pub is_staged: bool,
}

/// Writes a file: `row` is asked for the values of each row, from the top; NaN is a cell where nothing is
/// known.
///
/// Memory: 256 rows.
///
/// # Errors
/// Those of `row`; if writing fails.
pub fn write_rows<W: Write + Seek>(
    output: &mut W,
    file: &RasterFile,
    mut row: impl FnMut(u32, &mut [f32]) -> Result<()>,
) -> Result<()> {
    match file.options.format {
        RasterFormat::Ascii => ascii::write_rows(output, file, row),
        RasterFormat::GeoTiff => write_tiles(output, file, |tiles| tiles.rows(&mut row)),
    }
}

//! Rasters: values in cells of a grid, row by row from the top, and files of them.
//!
//! `grid` places cells, and `like` takes a grid from a file; `geotiff` and `ascii` write files, with
//! `no_data` for cells without data, `storage` for the numbers of a GeoTIFF, `date` for its time and
//! `reference` for the coordinate reference system; `mosaic` describes a raster in many files; `png` has
//! pictures; `relief` derives slope, aspect and shading from gradients.

mod ascii;
pub mod colour_map;
mod date;
mod geotiff;
mod grid;
mod like;
mod mosaic;
mod no_data;
mod png;
mod reference;
mod relief;
mod storage;
mod tags;

use std::io::{Seek, Write};
use std::path::PathBuf;

pub use date::Date;
pub use geotiff::{Reduction, TILE, Tiles, write_tiles};
pub use grid::{Cells, Grid, Window};
pub use mosaic::{IndexKind, Mosaic, Sheet};
pub use no_data::NoData;
pub use png::png;
pub use reference::{Reference, write_prj};
pub use relief::{Differences, Gradient, Light, Shading, aspect, rounded_aspect, slope};
pub use storage::{CellType, Compression, Integers, Predictor, Storage};

use spmesh_base::error::Result;

/// Formats of files.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum RasterFormat {
    /// Tiles of 256 by 256 cells, compressed; BigTIFF if it may be longer than 4 GiB.
    #[default]
    GeoTiff,
    /// ESRI ASCII grid, with as many digits as distinguish f32 values.
    Ascii,
}

/// How files are written.
#[derive(Debug, Clone, Default)]
pub struct RasterOptions {
    /// Their format.
    pub format: RasterFormat,
    /// The value of cells without data.
    pub no_data: NoData,
    /// Whether a GeoTIFF has overviews, and a layout for remote readers: overviews before the image, and
    /// tiles row by row.
    pub has_overviews: bool,
    /// How the numbers of a GeoTIFF become bytes.
    pub storage: Storage,
    /// Whether a GeoTIFF states statistics of its numbers.
    pub has_statistics: bool,
    /// The date that a GeoTIFF states.
    pub date: Option<Date>,
    /// Folder of temporary files; the system's if `None`.
    pub temp_dir: Option<PathBuf>,
}

/// What cells hold.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Samples {
    /// Floating-point numbers of 32 bits.
    #[default]
    Floats,
    /// Bytes from 1 to 255; 0 stands for no data.
    Bytes,
    /// Red, green, blue and opacity, as bytes. Cells without data are transparent. The values of a tile are four
    /// planes, one after the other.
    Colours,
}

impl Samples {
    /// Values of a cell.
    pub fn bands(self) -> usize {
        if self == Samples::Colours { 4 } else { 1 }
    }
}

/// A raster file to write.
#[derive(Debug, Clone, Copy)]
pub struct RasterFile<'a> {
    /// How it is written.
    pub options: &'a RasterOptions,
    /// Its cells.
    pub grid: Grid,
    /// Its coordinate reference system.
    pub reference: &'a Reference,
    /// How overviews are made.
    pub reduction: Reduction,
    /// What its cells hold.
    pub samples: Samples,
    /// Whether tiles are staged in a temporary file until all have come, so that they can be read back. Files
    /// with overviews and outputs that cannot seek are always staged.
    pub is_staged: bool,
}

impl RasterFile<'_> {
    /// The value of cells without data.
    fn no_data(&self) -> NoData {
        if self.samples == Samples::Floats { self.options.no_data } else { NoData(0.0) }
    }

    /// The integers that stand for values, if there are any.
    fn integers(&self) -> Option<&Integers> {
        self.options.storage.integers.as_ref().filter(|_| self.samples == Samples::Floats)
    }

    /// The type of stored numbers.
    pub fn cell_type(&self) -> CellType {
        match (self.samples, self.integers()) {
            (Samples::Floats, integers) => integers.map_or(CellType::Float32, |it| it.cell_type),
            (Samples::Bytes | Samples::Colours, _) => CellType::Byte,
        }
    }

    /// The stored number of cells without data, as text.
    pub fn no_data_text(&self) -> String {
        storage::no_data_text(self.integers(), self.no_data())
    }

    /// Scale and offset of stored numbers, unless these are the values.
    pub fn transform(&self) -> Option<[f64; 2]> {
        self.integers().map(|integers| [integers.scale, integers.offset])
    }

    /// Whether tiles of a GeoTIFF can be read back without loss while it is written.
    pub fn is_readable(&self) -> bool {
        self.samples == Samples::Floats && self.options.storage == Storage::default()
    }
}

/// Writes a file of one value per cell. `row` fills in the values of each row, from the top; NaN marks cells without data.
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

//! Flags, formats and outputs of the programs that write rasters.

use std::path::{Path, PathBuf};

use clap::Args;

use super::geotiff::GeoTiffFlags;
use super::resources::TempDirFlag;
use super::{Names, parse_numbers};
use spmesh_base::error::{Error, Result};
use spmesh_base::output::Output;
use spmesh_formats::raster::{Cells, Date, Grid, RasterFormat, RasterOptions, Window};
use spmesh_stream::Crs;

/// Flags for the grid of a raster.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Which cells there are")]
pub struct CellFlags {
    /// Side of cells; their corners are at multiples of it [default: a thousand cells along the longer side]
    #[arg(long, value_name = "S", allow_negative_numbers = true, conflicts_with_all = ["columns", "rows"])]
    step: Option<f64>,

    /// Corner from which the multiples of the step count [default: 0,0]
    #[arg(long, value_name = "X,Y", value_parser = parse_numbers::<2>, allow_hyphen_values = true, requires = "step")]
    align: Option<[f64; 2]>,

    /// Take the grid of this GeoTIFF, which must be in the system of the data
    #[arg(long, value_name = "FILE", conflicts_with_all = ["step", "columns", "rows", "bounds"])]
    like: Option<PathBuf>,

    /// Number of columns
    #[arg(long, value_name = "N", conflicts_with = "rows", value_parser = clap::value_parser!(u32).range(1..))]
    columns: Option<u32>,

    /// Number of rows
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    rows: Option<u32>,

    /// The window that the raster covers [default: all]
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_numbers::<4>, allow_hyphen_values = true)]
    bounds: Option<[f64; 4]>,
}

impl CellFlags {
    /// The grid that the flags ask for, for data in `crs`. `window` returns the extent of the data; it is
    /// called only if no flag states the extent.
    pub fn grid(&self, crs: &Crs, window: impl FnOnce() -> Result<Window>) -> Result<Grid> {
        match (&self.like, self.window()?) {
            (Some(like), _) => Grid::of_file_for(like, crs),
            (None, Some(given)) => Grid::of(given, self.cells()),
            (None, None) => Grid::of(window()?, self.cells()),
        }
    }

    /// The corner from which multiples of lengths count.
    pub fn anchor(&self) -> [f64; 2] {
        self.align.unwrap_or([0.0; 2])
    }

    /// The size of the cells.
    fn cells(&self) -> Cells {
        match (self.step, self.columns, self.rows) {
            (Some(step), ..) => Cells::Step { step, anchor: self.anchor() },
            (_, Some(columns), _) => Cells::Columns(columns),
            (_, _, Some(rows)) => Cells::Rows(rows),
            _ => Cells::Default,
        }
    }

    /// The window of `--bounds`, if it is given.
    fn window(&self) -> Result<Option<Window>> {
        self.bounds.map(window_of).transpose()
    }
}

/// Flags for the output of a raster.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "How rasters are written")]
pub struct RasterFlags {
    /// The number of cells without data, or nan [default: -9999; of integers the least, of bytes 255]
    #[arg(long, value_name = "VALUE", allow_hyphen_values = true)]
    no_data: Option<f64>,

    /// Write a cloud-optimised GeoTIFF, with overviews before the image
    #[arg(long)]
    cog: bool,

    #[command(flatten)]
    temp_dir: TempDirFlag,

    // A struct with another one in it has no group: its flags are named one by one where they conflict.
    #[command(flatten)]
    geotiff: GeoTiffFlags,
}

impl RasterFlags {
    /// Options for a format.
    ///
    /// # Errors
    /// Usage, if a flag is for another format.
    pub fn options(&self, format: RasterFormat) -> Result<RasterOptions> {
        if self.cog && format != RasterFormat::GeoTiff {
            return Err(Error::usage("--cog is for GeoTIFF: take an output that ends in .tif"));
        }
        let (no_data, storage) = self.geotiff.storage(self.no_data)?;
        if format != RasterFormat::GeoTiff {
            self.geotiff.check_unused()?;
        }
        Ok(RasterOptions {
            format,
            no_data,
            has_overviews: self.cog,
            storage,
            has_statistics: self.geotiff.has_statistics(),
            date: self.date(),
            temp_dir: self.temp_dir.to_owned(),
        })
    }

    /// The date that rasters state.
    pub fn date(&self) -> Option<Date> {
        self.geotiff.date()
    }

    /// The folder of temporary files, if it is not the system's.
    pub fn temp_dir(&self) -> Option<&Path> {
        self.temp_dir.get()
    }

    /// Checks the flags for a raster of bytes, in which 0 stands for no data.
    ///
    /// # Errors
    /// Usage, if another value is asked for.
    pub fn check_bytes(&self) -> Result<()> {
        if self.no_data.is_some_and(|no_data| no_data != 0.0) {
            return Err(Error::usage(
                "pictures are bytes in which 0 stands for no data: leave out --no-data",
            ));
        }
        self.geotiff.check_bytes()
    }

    /// Checks that no flag for rasters is given when the output is not a raster.
    ///
    /// # Errors
    /// Usage, if one of them is given.
    pub fn check_unused(&self) -> Result<()> {
        if self.cog || self.no_data.is_some() {
            return Err(Error::usage(
                "--cog and --no-data are for rasters: take an output that ends in .tif or .asc",
            ));
        }
        self.geotiff.check_unused()
    }
}

/// The window of `--bounds`.
pub fn window_of([x0, y0, x1, y1]: [f64; 4]) -> Result<Window> {
    if x0 < x1 && y0 < y1 {
        return Ok(Window { min: [x0, y0], max: [x1, y1] });
    }
    Err(Error::usage(format!(
        "bounds {x0},{y0},{x1},{y1} are empty: expected least x, least y, greatest x, greatest y"
    )))
}

/// The formats that endings of names stand for.
pub const ENDINGS: Names<RasterFormat> =
    &[("tif", RasterFormat::GeoTiff), ("tiff", RasterFormat::GeoTiff), ("asc", RasterFormat::Ascii)];

/// Opens the output of a raster before the work, so that a failure shows at once.
pub fn create(path: &Path, format: RasterFormat) -> Result<Output> {
    Output::create(path, format == RasterFormat::GeoTiff)
}

/// The size of the raster, for a notice.
pub fn summary(grid: &Grid, without_data: u64) -> String {
    let Grid { columns, rows, step, .. } = grid;
    let all = grid.cells();
    let without = match without_data {
        0 => String::new(),
        _ if without_data == all => ", none of which has data".to_string(),
        _ => format!(", {without_data} of {all} without data"),
    };
    format!("{columns} by {rows} cells of size {step}{without}")
}

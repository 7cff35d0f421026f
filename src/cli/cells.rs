//! What programs that write rasters have in common: flags that say which cells there are, formats, outputs.

use std::io::Seek;
use std::path::Path;

use clap::Args;

use super::parse_numbers;
use crate::error::{Error, Result};
use crate::output::Output;
use crate::raster::{Cells, Grid, RasterFormat, Window};

/// Which cells a raster has.
#[derive(Debug, Clone, Args)]
pub(super) struct CellFlags {
    /// Sides of cells, which are at multiples of it [default: a thousand cells along the longer side]
    #[arg(long, value_name = "S", allow_negative_numbers = true, conflicts_with_all = ["columns", "rows"])]
    step: Option<f64>,

    /// Number of columns
    #[arg(long, value_name = "N", conflicts_with = "rows", value_parser = clap::value_parser!(u32).range(1..))]
    columns: Option<u32>,

    /// Number of rows
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    rows: Option<u32>,

    /// What the raster covers [default: all that there is]
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_numbers::<4>, allow_hyphen_values = true)]
    bounds: Option<[f64; 4]>,
}

impl CellFlags {
    /// How large cells are.
    pub(super) fn cells(&self) -> Cells {
        match (self.step, self.columns, self.rows) {
            (Some(step), ..) => Cells::Step(step),
            (_, Some(columns), _) => Cells::Columns(columns),
            (_, _, Some(rows)) => Cells::Rows(rows),
            _ => Cells::Default,
        }
    }

    /// What the raster covers, if that is said.
    pub(super) fn window(&self) -> Result<Option<Window>> {
        self.bounds.map(window_of).transpose()
    }
}

/// What `--bounds` says.
pub(super) fn window_of([x0, y0, x1, y1]: [f64; 4]) -> Result<Window> {
    if x0 < x1 && y0 < y1 {
        return Ok(Window { min: [x0, y0], max: [x1, y1] });
    }
    Err(Error::usage(format!(
        "bounds {x0},{y0},{x1},{y1} are empty: expected least x, least y, greatest x, greatest y"
    )))
}

/// The format that the ending of a name tells.
pub(super) fn format_of(path: &Path) -> Option<RasterFormat> {
    let ending = path.extension()?.to_string_lossy().to_ascii_lowercase();
    match &ending[..] {
        "tif" | "tiff" => Some(RasterFormat::GeoTiff),
        "asc" => Some(RasterFormat::Ascii),
        _ => None,
    }
}

/// An output for a raster: what cannot be written is better known before the work.
pub(super) fn create(path: &Path, format: RasterFormat) -> Result<Output> {
    let is_tiff = format == RasterFormat::GeoTiff;
    let mut output = Output::create(path, is_tiff)?;
    if is_tiff && output.stream_position().is_err() {
        let what =
            "GeoTIFF is not written in order, and a pipe takes nothing else: use -o FILE, or --format asc";
        return Err(Error::usage(what));
    }
    Ok(output)
}

/// What was written, for a notice.
pub(super) fn summary(grid: &Grid, without_data: u64) -> String {
    let Grid { columns, rows, step, .. } = grid;
    let all = grid.cells();
    let without =
        if without_data > 0 { format!(", {without_data} of {all} without data") } else { String::new() };
    format!("{columns} by {rows} cells of size {step}{without}")
}

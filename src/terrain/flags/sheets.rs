//! Rasters in one file, or with `--tiles` in many.

use std::path::Path;

use clap::Args;

use crate::files::{Destination, Division, SheetSize, Sheets};
use spmesh_base::error::{Error, Result};
use spmesh_base::output::Output;
use spmesh_formats::raster::RasterFormat;
use spmesh_shell::cells::{self, CellFlags};

/// Flags that divide a raster.
#[derive(Debug, Clone, Args)]
pub(super) struct SheetFlags {
    /// Write many rasters in one pass: squares with sides of SIZE in world units, or NX columns and NY rows
    /// of rasters. With -o NAME.tif, they are NAME_X_Y.tif, where X, Y is the lower left corner of a square,
    /// or the column and the row, from 0 at the lower left. Their folder is made if necessary
    #[arg(long, value_name = "SIZE|NX,NY", value_parser = parse_size, allow_hyphen_values = true)]
    tiles: Option<SheetSize>,

    /// Margin of each raster of --tiles, in world units
    #[arg(long, value_name = "LENGTH", requires = "tiles", allow_negative_numbers = true)]
    buffer: Option<f64>,
}

/// The output of a run.
pub(super) enum RasterOutput {
    One(Output),
    Many(Sheets),
}

impl SheetFlags {
    /// Opens the output, so that a failure shows before the work.
    pub(super) fn create(
        &self,
        path: &Path,
        format: RasterFormat,
        flags: &CellFlags,
    ) -> Result<RasterOutput> {
        let Some(size) = self.tiles else {
            return Ok(RasterOutput::One(cells::create(path, format)?));
        };
        let buffer = self.buffer.unwrap_or(0.0);
        if !(buffer >= 0.0 && buffer.is_finite()) {
            return Err(Error::usage(format!("--buffer takes a length from 0 on, not {buffer}")));
        }
        let division = Division { size, anchor: flags.anchor(), buffer };
        Ok(RasterOutput::Many(Sheets::new(path, division, format)?))
    }
}

impl RasterOutput {
    /// Where the raster is written.
    pub(super) fn destination(&mut self) -> Destination<'_, Output> {
        match self {
            RasterOutput::One(output) => Destination::File(output),
            RasterOutput::Many(sheets) => Destination::Sheets(sheets),
        }
    }

    /// Gives the file its name; those of `--tiles` have theirs. Returns the bytes of all files.
    pub(super) fn commit(self) -> Result<Committed> {
        match self {
            RasterOutput::One(output) => {
                let bytes = output.bytes_written();
                output.commit()?;
                Ok(Committed { bytes, sheets: None })
            }
            RasterOutput::Many(Sheets { bytes, written, blank, .. }) => {
                Ok(Committed { bytes, sheets: Some([written, blank]) })
            }
        }
    }
}

/// What was written.
pub(super) struct Committed {
    /// Length of all files.
    pub(super) bytes: u64,
    /// Rasters of `--tiles`, and those without data.
    sheets: Option<[u64; 2]>,
}

impl Committed {
    /// The number of rasters, for a notice; `None` if it was always one.
    pub(super) fn notice(&self) -> Option<String> {
        let [written, blank] = self.sheets?;
        let rest = if blank > 0 { format!("; {blank} without data were not written") } else { String::new() };
        let rasters = if written == 1 { "raster" } else { "rasters" };
        Some(format!("{written} {rasters}{rest}"))
    }
}

/// Parses `SIZE` or `NX,NY`.
fn parse_size(text: &str) -> std::result::Result<SheetSize, String> {
    let wrong =
        || format!("expected the side of rasters, or two numbers of rasters such as 4,3, found \"{text}\"");
    let Some((across, down)) = text.split_once(',') else {
        return match text.trim().parse() {
            Ok(side) if side > 0.0 && f64::is_finite(side) => Ok(SheetSize::Side(side)),
            _ => Err(wrong()),
        };
    };
    let count = |text: &str| text.trim().parse().ok().filter(|&count: &u32| count > 0);
    match (count(across), count(down)) {
        (Some(across), Some(down)) => Ok(SheetSize::Counts([across, down])),
        _ => Err(wrong()),
    }
}

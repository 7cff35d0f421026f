//! Rasters in one file, or with `--tiles` in many.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::files::{Destination, Division, Index, Pattern, SheetSize, SheetTable, Sheets};
use spmesh_base::error::{Error, Result};
use spmesh_base::output::Output;
use spmesh_formats::raster::{IndexKind, RasterFormat, write_prj};
use spmesh_shell::cells::{self, CellFlags, RasterFlags};
use spmesh_shell::{Names, named};
use spmesh_stream::Crs;

/// Flags that divide a raster.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Many rasters in one pass")]
pub(super) struct SheetFlags {
    /// Write many rasters in one pass: squares with sides of SIZE in world units, or NX columns and NY rows
    /// of rasters. With -o NAME.tif, they are NAME_X_Y.tif, where X, Y is the lower left corner of a square,
    /// or the column and the row, from 0 at the lower left. Their folder is made if necessary
    #[arg(long, value_name = "SIZE|NX,NY", value_parser = parse_size, allow_hyphen_values = true)]
    tiles: Option<SheetSize>,

    /// Margin of each raster of --tiles, in world units
    #[arg(long, value_name = "LENGTH", requires = "tiles", allow_negative_numbers = true)]
    buffer: Option<f64>,

    /// Give all rasters of --tiles SIZE the cells of a whole square and its margin; beyond the raster there
    /// are no data
    #[arg(long, requires = "tiles")]
    full: bool,

    /// Names of rasters of --tiles, without their ending: {x} and {y} stand for the lower left corner of a
    /// square, {x_nw} and {y_nw} for the upper left one, {x_km}, {y_km}, {x_nw_km} and {y_nw_km} for these in
    /// thousands of units, {column} and {row} for numbers, {name} for that of -o, {sheet} for that of
    /// --tile-table. {x_km:4} is filled up to 4 digits [default: {name}_{x}_{y}, for NX,NY
    /// {name}_{column}_{row}]
    #[arg(long, value_name = "PATTERN", requires = "tiles")]
    tile_name: Option<Pattern>,

    /// Names of squares of --tiles, for the field {sheet} of --tile-name, which is the default then: text
    /// with x and y of the lower left corner and the name on each line. Squares without a name are not
    /// written
    #[arg(long, value_name = "FILE", requires = "tiles")]
    tile_table: Option<PathBuf>,

    /// Describe the rasters of --tiles in files beside them, named as that of -o: vrt and gti, which GDAL
    /// reads as one raster (gti for very many, with its geojson), geojson with their outlines, stac with a
    /// collection and an item for each raster. The latter needs --date
    #[arg(long, value_name = "KINDS", value_delimiter = ',', value_parser = named(INDEXES), requires = "tiles")]
    tile_index: Vec<IndexKind>,
}

/// The values of `--index`.
const INDEXES: Names<IndexKind> = &[
    ("vrt", IndexKind::Vrt),
    ("gti", IndexKind::Gti),
    ("geojson", IndexKind::GeoJson),
    ("stac", IndexKind::Stac),
];

/// The output of a run.
pub(super) enum RasterOutput {
    One(Output, PathBuf, RasterFormat),
    Many(Sheets),
}

impl SheetFlags {
    /// Opens the output, so that a failure shows before the work.
    pub(super) fn create(
        &self,
        path: &Path,
        format: RasterFormat,
        flags: &CellFlags,
        raster: &RasterFlags,
    ) -> Result<RasterOutput> {
        let Some(size) = self.tiles else {
            return Ok(RasterOutput::One(cells::create(path, format)?, path.into(), format));
        };
        let buffer = self.buffer.unwrap_or(0.0);
        if !(buffer >= 0.0 && buffer.is_finite()) {
            return Err(Error::usage(format!("--buffer takes a length from 0 on, not {buffer}")));
        }
        let division = Division { size, anchor: flags.anchor(), buffer, is_full: self.full };
        let names = self.names(size, &division)?;
        let index = Index::new(&self.tile_index, raster.date())?;
        Ok(RasterOutput::Many(Sheets::new(path, division, names, index, format)?))
    }
}

impl SheetFlags {
    /// How rasters are named.
    fn names(&self, size: SheetSize, division: &Division) -> Result<Pattern> {
        let table = match (&self.tile_table, size) {
            (None, _) => None,
            (Some(path), SheetSize::Side(side)) => Some(SheetTable::read(path, side, division.anchor)?),
            (Some(_), SheetSize::Counts(_)) => {
                return Err(Error::usage(
                    "--tile-table names squares: give --tiles the length of their side",
                ));
            }
        };
        let usual = || if table.is_some() { Pattern::of_table() } else { Pattern::usual(size) };
        self.tile_name.clone().unwrap_or_else(usual).with_table(table)
    }
}

impl RasterOutput {
    /// Where the raster is written.
    pub(super) fn destination(&mut self) -> Destination<'_, Output> {
        match self {
            RasterOutput::One(output, ..) => Destination::File(output),
            RasterOutput::Many(sheets) => Destination::Sheets(sheets),
        }
    }

    /// Gives the file its name, and an ESRI grid its system beside it; those of `--tiles` have theirs.
    /// Returns the bytes of all files.
    pub(super) fn commit(self, crs: &Crs) -> Result<Committed> {
        match self {
            RasterOutput::One(output, path, format) => {
                let bytes = output.bytes_written();
                let lost = if format == RasterFormat::Ascii { write_prj(&path, crs)? } else { None };
                output.commit()?;
                Ok(Committed { bytes, sheets: None, lost })
            }
            RasterOutput::Many(Sheets { bytes, written, blank, unnamed, .. }) => {
                Ok(Committed { bytes, sheets: Some([written, blank, unnamed]), lost: None })
            }
        }
    }
}

/// What was written.
pub(super) struct Committed {
    /// Length of all files.
    pub(super) bytes: u64,
    /// Rasters of `--tiles`, those without data, and those without a name.
    sheets: Option<[u64; 3]>,
    /// What the file cannot hold.
    lost: Option<String>,
}

impl Committed {
    /// The number of rasters, or what the one cannot hold, for a notice; `None` if there is nothing to say.
    pub(super) fn notice(&self) -> Option<String> {
        let Some([written, blank, unnamed]) = self.sheets else { return self.lost.clone() };
        let mut rest =
            if blank > 0 { format!("; {blank} without data were not written") } else { String::new() };
        if unnamed > 0 {
            rest += &format!("; {unnamed} squares without a name in --tile-table were not written");
        }
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

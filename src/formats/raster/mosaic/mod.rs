//! Files that describe a raster which is in many files: what its files are, where they are, and how they make
//! one raster.

mod index;
mod stac;
mod virtual_raster;

use std::io::Write;
use std::ops::Range;

use super::{Date, Grid, RasterFile};
use spmesh_base::error::{Error, Result};

/// Kinds of such files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IndexKind {
    /// A virtual raster of GDAL.
    Vrt,
    /// A tile index that GDAL reads as a raster; it needs the GeoJSON.
    Gti,
    /// The outlines of the files, as GeoJSON.
    GeoJson,
    /// A collection of SpatioTemporal assets, with an item for each file.
    Stac,
}

impl IndexKind {
    /// The end of its name, behind that of the raster and a point.
    pub fn ending(self) -> &'static str {
        match self {
            IndexKind::Vrt => "vrt",
            IndexKind::Gti => "gti",
            IndexKind::GeoJson => "geojson",
            IndexKind::Stac => "collection.json",
        }
    }
}

/// One of the files.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// Its name without the ending.
    pub name: String,
    /// Its name in the folder.
    pub file_name: String,
    /// Columns and rows of the whole raster, which may be beyond those of its grid.
    pub cells: [Range<i64>; 2],
}

/// A raster in many files.
pub struct Mosaic<'a> {
    /// The raster that was divided.
    pub file: &'a RasterFile<'a>,
    /// Its name without an ending.
    pub name: &'a str,
    /// The folder of all files, from the root: GDAL looks for the index of a GTI in the folder in which it
    /// was started.
    pub folder: &'a str,
    /// The date of the data.
    pub date: Option<Date>,
    /// The number of files.
    pub count: usize,
    /// A file by its number.
    pub sheet: &'a dyn Fn(usize) -> Sheet,
}

impl Mosaic<'_> {
    fn sheets(&self) -> impl Iterator<Item = Sheet> {
        (0..self.count).map(self.sheet)
    }

    /// The cells of all files.
    fn cells(&self) -> [Range<i64>; 2] {
        let join = |a: Range<i64>, b: Range<i64>| a.start.min(b.start)..a.end.max(b.end);
        let all = self.sheets().map(|sheet| sheet.cells);
        let grid = &self.file.grid;
        all.reduce(|[columns, rows], [more_columns, more_rows]| {
            [join(columns, more_columns), join(rows, more_rows)]
        })
        .unwrap_or([0..grid.columns.into(), 0..grid.rows.into()])
    }

    /// The grid of a file.
    fn grid(&self, sheet: &Sheet) -> Grid {
        self.file.grid.part(&sheet.cells)
    }

    /// The code of x and y, if there is one, as programs take it.
    fn code(&self) -> Option<String> {
        self.file.reference.epsg_code().map(|code| format!("EPSG:{code}"))
    }

    /// The coordinate reference system for programs that read codes and well-known text.
    fn system(&self) -> Option<String> {
        self.code().or_else(|| self.file.reference.text())
    }

    /// Writes a description.
    ///
    /// # Errors
    /// Usage, for a collection without a date; if writing fails.
    pub fn write(&self, kind: IndexKind, output: &mut dyn Write) -> Result<()> {
        let written = match kind {
            IndexKind::Vrt => virtual_raster::write_vrt(self, output),
            IndexKind::Gti => virtual_raster::write_gti(self, output),
            IndexKind::GeoJson => index::write(self, output),
            IndexKind::Stac => stac::write_collection(self, self.stated_date()?, output),
        };
        written.and_then(|()| output.flush()).map_err(|e| Error::io("writing", e))
    }

    /// The item of a file in a collection, as JSON.
    ///
    /// # Errors
    /// Usage, without a date.
    pub fn item(&self, sheet: &Sheet) -> Result<String> {
        Ok(stac::item(self, sheet, self.stated_date()?))
    }

    fn stated_date(&self) -> Result<Date> {
        self.date.ok_or_else(|| Error::usage("STAC items have the date of the data: give --date"))
    }
}

/// Least x and y, greatest x and y.
fn bounds(grid: &Grid) -> [f64; 4] {
    [grid.left, grid.bottom(), grid.left + f64::from(grid.columns) * grid.step, grid.top]
}

/// The corners of a grid, anticlockwise, with the first one again at the end.
fn ring(grid: &Grid) -> [[f64; 2]; 5] {
    let [left, bottom, right, top] = bounds(grid);
    [[left, bottom], [right, bottom], [right, top], [left, top], [left, bottom]]
}

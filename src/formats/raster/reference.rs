//! What a raster says of its coordinates.

use std::fs;
use std::io::Write;
use std::path::Path;

use crate::crs::{self, GeoKeys, System, geotiff_keys};
use crate::lines::write_geojson::epsg_code;
use crate::raster::RasterFormat;
use spmesh_base::error::{Error, Result};
use spmesh_base::output::Output;
use spmesh_stream::Crs;

/// A coordinate reference system, as files of a format hold it.
#[derive(Debug, Clone, Default)]
pub struct Reference {
    pub(super) keys: GeoKeys,
    /// The unit of cells that hold elevations, if the keys do not say it.
    pub(super) unit: Option<String>,
    /// What the file cannot say of the system: each a sentence for users.
    pub notices: Vec<String>,
    crs: Crs,
}

/// Writes the system of an ESRI grid to a file beside it, which ends in `.prj`: as WKT 1, since programs take
/// no notice of WKT 2 there. Returns what cannot be held, as a sentence for users: the system of a grid on
/// its way to another program.
///
/// # Errors
/// If writing fails; usage, if the file is an input of this run.
pub fn write_prj(grid: &Path, crs: &Crs) -> Result<Option<String>> {
    let Some(name) = crs::name(crs) else { return Ok(None) };
    let lost = format!("an ESRI grid cannot hold the coordinate reference system {name}");
    // [`Reference::of_crs`] tells of systems without such text.
    let Some(text) = crs::text1(crs) else { return Ok(None) };
    if grid == Path::new("-") || fs::metadata(grid).is_ok_and(|found| !found.is_file()) {
        return Ok(Some(format!("{lost}: with -o NAME.asc, NAME.prj does")));
    }
    let mut output = Output::create(&grid.with_extension("prj"), false)?;
    writeln!(output, "{text}").map_err(|e| Error::io("writing", e))?;
    output.commit().map(|()| None)
}

impl Reference {
    /// What a file of `format` says of `crs`; of its vertical part, if cells hold elevations.
    pub fn of_crs(crs: &Crs, are_elevations: bool, format: RasterFormat) -> Reference {
        let system = System::of(crs);
        let mut reference = Reference { crs: crs.clone(), ..Reference::default() };
        if format == RasterFormat::GeoTiff {
            (reference.keys, reference.notices) = geotiff_keys(&system, are_elevations);
            let bare = system.vertical.as_ref().filter(|heights| are_elevations && heights.is_only_unit());
            reference.unit = bare.map(|heights| heights.unit.name.clone());
        } else if let Some(name) = system.name().filter(|_| crs::text1(crs).is_none()) {
            let loss = format!("an ESRI grid cannot hold the coordinate reference system {name}");
            reference.notices.push(loss);
        }
        reference
    }

    /// The EPSG code of the system of x and y, if it has one.
    pub fn epsg_code(&self) -> Option<u32> {
        epsg_code(&self.crs)
    }

    /// The definition of the system as well-known text, if it has one.
    pub fn text(&self) -> Option<String> {
        crs::text(&self.crs)
    }

    /// As [`write_prj`], for a grid of this system.
    ///
    /// # Errors
    /// As [`write_prj`].
    pub fn write_prj(&self, grid: &Path) -> Result<()> {
        write_prj(grid, &self.crs).map(drop)
    }

    /// Whether x and y are degrees of longitude and latitude on WGS 84.
    pub(super) fn is_wgs84(&self) -> bool {
        System::of(&self.crs).is_wgs84()
    }
}

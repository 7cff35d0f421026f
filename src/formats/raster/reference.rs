//! What a raster says of its coordinates.

use crate::crs::{GeoKeys, System, geotiff_keys};
use crate::raster::RasterFormat;
use spmesh_stream::Crs;

/// A coordinate reference system, as files of a format hold it.
#[derive(Debug, Clone, Default)]
pub struct Reference {
    pub(super) keys: GeoKeys,
    /// The unit of cells that hold elevations, if the keys do not say it.
    pub(super) unit: Option<String>,
    /// What the file cannot say of the system: each a sentence for users.
    pub notices: Vec<String>,
}

impl Reference {
    /// What a file of `format` says of `system`; of its vertical part, if cells hold elevations.
    pub fn of(system: &System, are_elevations: bool, format: RasterFormat) -> Reference {
        match (format, system.name()) {
            (RasterFormat::GeoTiff, _) => {
                let (keys, notices) = geotiff_keys(system, are_elevations);
                let bare =
                    system.vertical.as_ref().filter(|heights| are_elevations && heights.is_only_unit());
                Reference { keys, unit: bare.map(|heights| heights.unit.name.clone()), notices }
            }
            (RasterFormat::Ascii, None) => Reference::default(),
            (RasterFormat::Ascii, Some(name)) => {
                let loss = format!("an ESRI grid cannot hold the coordinate reference system {name}");
                Reference { notices: vec![loss], ..Reference::default() }
            }
        }
    }

    /// As [`Reference::of`], of a system in a stream.
    pub fn of_crs(crs: &Crs, are_elevations: bool, format: RasterFormat) -> Reference {
        Reference::of(&System::of(crs), are_elevations, format)
    }
}

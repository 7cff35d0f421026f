//! What a raster says of its coordinates.

use crate::crs::{GeoKeys, System, geotiff_keys};
use crate::raster::RasterFormat;
use spmesh_stream::Crs;

/// A coordinate reference system, as files of a format hold it.
#[derive(Debug, Clone, Default)]
pub struct Reference {
    pub(super) keys: GeoKeys,
    /// What the file cannot say of the system: each a sentence for users.
    pub notices: Vec<String>,
}

impl Reference {
    /// What a file of `format` says of `system`; of its vertical part, if cells hold elevations.
    pub fn of(system: &System, are_elevations: bool, format: RasterFormat) -> Reference {
        let (keys, notices) = match (format, system.name()) {
            (RasterFormat::GeoTiff, _) => geotiff_keys(system, are_elevations),
            (RasterFormat::Ascii, None) => Default::default(),
            (RasterFormat::Ascii, Some(name)) => {
                let loss = format!("an ESRI grid cannot hold the coordinate reference system {name}");
                (GeoKeys::default(), vec![loss])
            }
        };
        Reference { keys, notices }
    }

    /// As [`Reference::of`], of a system in a stream.
    pub fn of_crs(crs: &Crs, are_elevations: bool, format: RasterFormat) -> Reference {
        Reference::of(&System::of(crs), are_elevations, format)
    }
}

//! The outlines of files as GeoJSON.

use std::io::{self, Write};

use serde_json::json;

use super::{Mosaic, ring};
use crate::lines::write_geojson::collection_head;

/// Writes a feature for each file, with its name and, as tile indexes of GDAL have it, its location.
/// Coordinates are those of the raster.
pub(super) fn write(mosaic: &Mosaic, output: &mut dyn Write) -> io::Result<()> {
    write!(output, "{}", collection_head(mosaic.file.reference.epsg_code()))?;
    for (number, sheet) in mosaic.sheets().enumerate() {
        let feature = json!({
            "type": "Feature",
            "properties": {"name": sheet.name, "location": sheet.file_name},
            "geometry": {"type": "Polygon", "coordinates": [ring(&mosaic.grid(&sheet))]},
        });
        write!(output, "{}{feature}", if number > 0 { ",\n" } else { "\n" })?;
    }
    writeln!(output, "\n]}}")
}

//! Collections of SpatioTemporal assets (STAC 1.1.0), with the projection extension 2.0.0.
//!
//! STAC has places in longitude and latitude on WGS 84. Coordinates are not transformed here, so items in
//! another system have no geometry, which the specification allows, but state their system and their place in
//! it.

use std::fmt::Write as _;
use std::io::{self, Write};

use serde_json::{Map, Value, json};

use super::{IndexKind, Mosaic, Sheet, bounds, ring};
use crate::raster::{Date, Grid, RasterFormat, Samples};

const VERSION: &str = "1.1.0";
const PROJECTION: &str = "https://stac-extensions.github.io/projection/v2.0.0/schema.json";
const RASTER: &str = "https://stac-extensions.github.io/raster/v2.0.0/schema.json";
/// A box that holds all places.
const EARTH: [f64; 4] = [-180.0, -90.0, 180.0, 90.0];

/// Least and greatest longitude and latitude of a grid, if these are its coordinates.
fn degrees(mosaic: &Mosaic, grid: &Grid) -> Option<[f64; 4]> {
    let [west, south, east, north] = bounds(grid);
    let is_on_earth = west >= EARTH[0] && south >= EARTH[1] && east <= EARTH[2] && north <= EARTH[3];
    (mosaic.file.reference.is_wgs84() && is_on_earth).then_some([west, south, east, north])
}

/// The item of a file.
pub(super) fn item(mosaic: &Mosaic, sheet: &Sheet, date: Date) -> String {
    let (grid, collection) = (mosaic.grid(sheet), link_to_collection(mosaic));
    let mut properties = json!({
        "datetime": date.text(),
        "proj:code": mosaic.code(),
        "proj:bbox": bounds(&grid),
        "proj:shape": [grid.rows, grid.columns],
        "proj:transform": [grid.step, 0.0, grid.left, 0.0, -grid.step, grid.top],
    });
    if mosaic.code().is_none()
        && let Some(text) = mosaic.file.reference.text()
    {
        properties["proj:wkt2"] = text.into();
    }
    let mut extensions = vec![PROJECTION];
    if mosaic.file.transform().is_some() {
        extensions.push(RASTER);
    }
    let link = |relation: &str| json!({"rel": relation, "href": collection, "type": "application/json"});
    let mut item = json!({
        "type": "Feature",
        "stac_version": VERSION,
        "stac_extensions": extensions,
        "id": sheet.name,
        "collection": mosaic.name,
        "geometry": null,
        "properties": properties,
        "links": [link("root"), link("parent"), link("collection")],
        "assets": {"data": asset(mosaic, sheet)},
    });
    if let Some(bounds) = degrees(mosaic, &grid) {
        item["bbox"] = json!(bounds);
        item["geometry"] = json!({"type": "Polygon", "coordinates": [ring(&grid)]});
    }
    format!("{item:#}\n")
}

/// The file of an item.
fn asset(mosaic: &Mosaic, sheet: &Sheet) -> Value {
    let file = mosaic.file;
    let kind = match (file.options.format, file.options.has_overviews) {
        (RasterFormat::Ascii, _) => "text/plain",
        (RasterFormat::GeoTiff, false) => "image/tiff; application=geotiff",
        (RasterFormat::GeoTiff, true) => "image/tiff; application=geotiff; profile=cloud-optimized",
    };
    let mut asset = Map::new();
    asset.insert("href".into(), format!("./{}", encoded(&sheet.file_name)).into());
    asset.insert("type".into(), kind.into());
    asset.insert("roles".into(), json!([if file.samples == Samples::Colours { "visual" } else { "data" }]));
    if file.samples != Samples::Colours {
        let no_data = file.no_data_text();
        let number = no_data.parse::<f64>().ok().filter(|number| number.is_finite());
        asset.insert("nodata".into(), number.map_or_else(|| no_data.into(), Value::from));
        let type_name = match file.cell_type().name() {
            "Byte" => "uint8".to_string(),
            name => name.to_ascii_lowercase(),
        };
        asset.insert("data_type".into(), type_name.into());
    }
    if let Some(unit) = &file.reference.unit {
        asset.insert("unit".into(), unit.as_str().into());
    }
    if let Some([scale, offset]) = file.transform() {
        asset.insert("raster:scale".into(), scale.into());
        asset.insert("raster:offset".into(), offset.into());
    }
    Value::Object(asset)
}

/// Writes the collection.
pub(super) fn write_collection(mosaic: &Mosaic, date: Date, output: &mut dyn Write) -> io::Result<()> {
    let place = degrees(mosaic, &mosaic.file.grid.part(&mosaic.cells()));
    let caution = match place {
        Some(_) => "",
        None => {
            " Coordinates were not transformed: items state their place in their own system, and the extent is that of \
             the Earth."
        }
    };
    let plural = if mosaic.count == 1 { "file" } else { "files" };
    let collection = json!({
        "type": "Collection",
        "stac_version": VERSION,
        "id": mosaic.name,
        "description": format!("A raster in {} {plural}.{caution}", mosaic.count),
        "license": "other",
        "extent": {
            "spatial": {"bbox": [place.unwrap_or(EARTH)]},
            "temporal": {"interval": [[date.text(), date.text()]]},
        },
    });
    // Links are written one by one: there may be very many.
    let (text, root) = (collection.to_string(), link_to_collection(mosaic));
    writeln!(output, "{},\"links\":[", text.strip_suffix('}').unwrap_or(&text))?;
    write!(output, "{}", json!({"rel": "root", "href": root, "type": "application/json"}))?;
    for sheet in mosaic.sheets() {
        let href = format!("./{}.json", encoded(&sheet.name));
        write!(output, ",\n{}", json!({"rel": "item", "href": href, "type": "application/geo+json"}))?;
    }
    writeln!(output, "\n]}}")
}

fn link_to_collection(mosaic: &Mosaic) -> String {
    format!("./{}.{}", encoded(mosaic.name), IndexKind::Stac.ending())
}

/// A name of a file as part of a URL (RFC 3986, section 2).
fn encoded(name: &str) -> String {
    let mut text = String::new();
    for byte in name.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~".contains(&byte) {
            text.push(byte.into());
        } else {
            write!(text, "%{byte:02X}").expect("a text takes all that is written");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::encoded;

    #[test]
    fn names_are_parts_of_urls() {
        assert_eq!(encoded("a_1.5-é b%.tif"), "a_1.5-%C3%A9%20b%25.tif");
    }
}

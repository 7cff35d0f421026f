//! The tag in which GDAL keeps what TIFF has no tag for, in XML.

use super::directory::Values;
use super::statistics::Statistics;
use super::{GDAL_METADATA, RasterFile};

/// Longest text of a statistic, with its item: numbers have at most 24 characters.
const ITEM_LEN: usize = 100;
/// Items of statistics.
const ITEMS: usize = 5;

/// The tag, if there is anything to say. Its length does not depend on the statistics.
pub(super) fn tag(file: &RasterFile, statistics: Option<&Statistics>) -> Option<(u16, Values)> {
    let mut items = String::new();
    let mut add = |name: &str, role: &str, value: &str| {
        let role = if role.is_empty() { String::new() } else { format!(" role=\"{role}\"") };
        items += &format!("  <Item name=\"{name}\" sample=\"0\"{role}>{value}</Item>\n");
    };
    if let Some(integers) = file.integers() {
        add("OFFSET", "offset", &integers.offset.to_string());
        add("SCALE", "scale", &integers.scale.to_string());
    }
    if let Some(unit) = &file.reference.unit {
        let is_plain = |c: &char| c.is_ascii_graphic() && !"<>&".contains(*c) || *c == ' ';
        add("UNITTYPE", "unittype", &unit.chars().filter(is_plain).collect::<String>());
    }
    if file.options.has_statistics {
        let len = items.len() + ITEMS * ITEM_LEN;
        for (name, value) in statistics.iter().flat_map(|it| it.items(file.grid.cells())) {
            items += &format!("  <Item name=\"{name}\" sample=\"0\">{value:e}</Item>\n");
        }
        items += &" ".repeat(len - items.len());
    }
    let text = format!("<GDALMetadata>\n{items}</GDALMetadata>\n");
    (!items.is_empty()).then_some((GDAL_METADATA, Values::Text(text)))
}

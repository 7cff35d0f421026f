//! The parts of GeoJSON that lines and polygons share.

use std::io::Read;

use serde_json::Value;

use crate::detect::BYTE_ORDER_MARK;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::GEOJSON_LEN_MAX;
use spmesh_stream::model::points::Point2;

/// Whether a text that starts with these bytes is JSON.
pub(crate) fn is_json(head: &[u8]) -> bool {
    without_mark(head).trim_ascii_start().starts_with(b"{")
}

/// Bytes without the byte order mark before them, if there is one.
fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes)
}

/// Reads the rest of a small file behind its first bytes, and removes a byte order mark; `remedy` says what to do
/// if the file is too long.
pub(crate) fn read_rest(input: impl Read, mut head: Vec<u8>, remedy: &str) -> Result<Vec<u8>> {
    let most = GEOJSON_LEN_MAX + 1 - head.len() as u64;
    input.take(most).read_to_end(&mut head).map_err(|e| Error::io("reading", e))?;
    if head.len() as u64 > GEOJSON_LEN_MAX {
        return Err(Error::malformed(format!("more than {GEOJSON_LEN_MAX} bytes: {remedy}")));
    }
    head.drain(..head.len() - without_mark(&head).len());
    Ok(head)
}

/// Parses a text.
pub(crate) fn parse(bytes: &[u8]) -> Result<Value> {
    serde_json::from_slice(bytes).map_err(|e| Error::malformed(format!("not JSON: {e}")))
}

/// Calls `found` with each feature of a collection, or with the only feature or geometry.
pub(crate) fn for_each_feature(value: &Value, mut found: impl FnMut(&Value) -> Result<()>) -> Result<()> {
    let features = match type_of(value) {
        "FeatureCollection" => match value.get("features").and_then(Value::as_array) {
            Some(features) => features.iter().collect(),
            None => return Err(Error::malformed("not GeoJSON: a collection has no features")),
        },
        _ => vec![value],
    };
    let mut features = features.into_iter().enumerate();
    features.try_for_each(|(number, feature)| found(feature).map_err(|e| e.at(format!("feature {number}"))))
}

/// The geometry of a feature, or a geometry itself.
pub(crate) fn geometry_of(feature: &Value) -> &Value {
    if type_of(feature) == "Feature" { member(feature, "geometry") } else { feature }
}

/// The type of an object; empty if it has none.
pub(crate) fn type_of(value: &Value) -> &str {
    value.get("type").and_then(Value::as_str).unwrap_or_default()
}

/// A member of an object, null if it is not there.
pub(crate) fn member<'a>(value: &'a Value, name: &str) -> &'a Value {
    value.get(name).unwrap_or(&Value::Null)
}

/// The items of a list.
pub(crate) fn array(value: &Value) -> Result<&Vec<Value>> {
    value.as_array().ok_or_else(|| Error::malformed("not GeoJSON: coordinates are no list"))
}

/// A position, without its third coordinate.
pub(crate) fn position(value: &Value) -> Result<Point2> {
    let numbers: Option<Vec<f64>> = array(value)?.iter().map(Value::as_f64).collect();
    match numbers.as_deref() {
        Some(&[x, y, ..]) => Ok([x, y]),
        _ => Err(Error::malformed("not GeoJSON: a position is not two numbers or more")),
    }
}

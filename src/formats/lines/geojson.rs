//! GeoJSON, read as it arrives: of a file of many lines, only the numbers are held.
//!
//! Members of an object may come in any order, so coordinates are read before it is known of what geometry
//! they are: as numbers, with the nesting of lists.

mod coordinates;

use std::fmt;
use std::io::Read;

use serde_core::de::{DeserializeSeed, Deserializer, Error as _, IgnoredAny, MapAccess, SeqAccess, Visitor};

use crate::crs::requested;
use crate::detect::BYTE_ORDER_MARK;
use crate::lines::collect::Shape;
use crate::lines::{Breaklines, Collector, Properties, Reading, without_mark};
use coordinates::{Coordinates, Whole};
use spmesh_base::error::{Error, Result};
use spmesh_stream::Crs;
use spmesh_stream::model::points::Point2;

type JsonResult<T, E> = std::result::Result<T, E>;

/// Greatest longitude and latitude.
const DEGREES: [f64; 2] = [180.0, 90.0];

/// Whether a text that starts with these bytes is JSON.
pub(crate) fn is_json(head: &[u8]) -> bool {
    without_mark(head).trim_ascii_start().starts_with(b"{")
}

/// Reads GeoJSON.
pub(crate) fn read(mut input: impl Read, reading: &Reading) -> Result<Breaklines> {
    let mut start = Vec::new();
    let len = BYTE_ORDER_MARK.len() as u64;
    input.by_ref().take(len).read_to_end(&mut start).map_err(|e| Error::io("reading", e))?;
    if start == BYTE_ORDER_MARK {
        start.clear();
    }
    let mut file = File { lines: Collector::new(reading), feature: 0, system: None, failure: None };
    let mut json = serde_json::Deserializer::from_reader(start.chain(input));
    let read = Object { file: &mut file, is_root: true }.deserialize(&mut json);
    let read = read.and_then(|root| root.finish(&mut file).map_err(serde_json::Error::custom));
    read.and_then(|()| json.end()).map_err(|error| failure(error, file.failure.take()))?;
    let crs = file.system.as_deref().map_or(Ok(Crs::Unknown), system)?;
    let mut lines = file.lines.finish(crs)?;
    let are_degrees = |[x, y]: &Point2| x.abs() <= DEGREES[0] && y.abs() <= DEGREES[1];
    lines.system.may_be_degrees =
        file.system.is_none() && lines.lines.iter().flat_map(|line| &line.vertices).all(are_degrees);
    Ok(lines)
}

/// The error of a file: that of this program if it found one.
fn failure(error: serde_json::Error, own: Option<Error>) -> Error {
    match own {
        Some(own) => own,
        None if error.is_io() => Error::io("reading", error.into()),
        None if error.is_eof() => Error::malformed(format!("not JSON: the file is cut off: {error}")),
        None if error.is_syntax() => Error::malformed(format!("not JSON: {error}")),
        None => Error::malformed(format!("not GeoJSON: {error}")),
    }
}

/// The system of a `crs` member.
fn system(name: &str) -> Result<Crs> {
    let code = name.rsplit(':').next().unwrap_or_default();
    if name.contains("CRS84") {
        return requested("EPSG:4326");
    }
    if !name.to_ascii_uppercase().contains("EPSG") {
        let message =
            format!("the member crs names {name:?}, expected a code of EPSG: remove it, or write another");
        return Err(Error::usage(message));
    }
    requested(&format!("EPSG:{code}"))
}

/// What is known of a file.
struct File {
    lines: Collector,
    /// Number of the feature that is read, from 0.
    feature: u64,
    /// Name of the system.
    system: Option<String>,
    /// An error that is no fault of JSON.
    failure: Option<Error>,
}

/// Reads an object: a collection, a feature or a geometry. The features of a collection are entered as they
/// come.
struct Object<'a> {
    file: &'a mut File,
    is_root: bool,
}

/// An object that was read.
#[derive(Default)]
struct Found {
    kind: Option<String>,
    coordinates: Option<Coordinates>,
    /// The geometry of a feature, or those of a collection.
    parts: Option<Vec<Found>>,
    has_features: bool,
    properties: Properties,
}

/// The properties of a feature that have a meaning here. Strings and numbers with the same text are equal.
fn properties(value: &serde_json::Value, mut found: Properties) -> Properties {
    for (name, value) in value.as_object().into_iter().flatten() {
        if let Some(property) = found.of_name(name) {
            *property = match value {
                serde_json::Value::Null => None,
                serde_json::Value::String(text) => Some(text.clone()),
                other => Some(other.to_string()),
            };
        }
    }
    found
}

impl Found {
    /// Enters the lines of a feature or geometry.
    fn finish(self, file: &mut File) -> JsonResult<(), String> {
        let kind = self.kind.as_deref().unwrap_or_default();
        match kind {
            "FeatureCollection" if self.has_features => return Ok(()),
            "FeatureCollection" => return Err("a collection has no features".into()),
            "Feature" | "GeometryCollection" => {
                if kind == "Feature" {
                    file.lines.feature(self.properties);
                }
                let mut parts = self.parts.unwrap_or_default().into_iter();
                return parts.try_for_each(|part| part.finish(file));
            }
            _ => {}
        }
        let (depth, shape) = match kind {
            "Point" => (1, Shape::Points),
            "MultiPoint" => (2, Shape::Points),
            "LineString" => (2, Shape::Line),
            "MultiLineString" => (3, Shape::Line),
            "Polygon" => (3, Shape::Ring),
            "MultiPolygon" => (4, Shape::Ring),
            other => return Err(format!("feature {}: {other:?} is no geometry", file.feature)),
        };
        let feature = file.feature;
        let coordinates =
            self.coordinates.ok_or_else(|| format!("feature {feature}: {kind} has no coordinates"))?;
        if coordinates.depth != 0 && coordinates.depth != depth {
            let found = coordinates.depth;
            return Err(format!(
                "feature {feature}: coordinates of {kind} are {found} lists deep, expected {depth}"
            ));
        }
        let entered = coordinates.enter(shape, depth, &mut file.lines, || format!("feature {feature}"));
        entered.map_err(|error| {
            file.failure = Some(error);
            String::new()
        })
    }
}

impl<'de> DeserializeSeed<'de> for Object<'_> {
    type Value = Found;

    fn deserialize<D: Deserializer<'de>>(self, input: D) -> JsonResult<Found, D::Error> {
        input.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Object<'_> {
    type Value = Found;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object of GeoJSON")
    }

    /// A feature may have no geometry: it is an empty collection.
    fn visit_unit<E>(self) -> JsonResult<Found, E> {
        Ok(Found { kind: Some("GeometryCollection".into()), ..Found::default() })
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> JsonResult<Found, A::Error> {
        let mut found = Found::default();
        while let Some(name) = members.next_key::<String>()? {
            match &name[..] {
                "type" => found.kind = members.next_value()?,
                "coordinates" => found.coordinates = Some(members.next_value_seed(Whole)?),
                "geometry" => {
                    let part = Object { file: &mut *self.file, is_root: false };
                    found.parts = Some(vec![members.next_value_seed(part)?]);
                }
                "geometries" => {
                    let parts = Objects { file: &mut *self.file, are_features: false };
                    found.parts = Some(members.next_value_seed(parts)?);
                }
                "properties" => {
                    found.properties = properties(&members.next_value()?, self.file.lines.no_properties());
                }
                "features" if self.is_root => {
                    members.next_value_seed(Objects { file: &mut *self.file, are_features: true })?;
                    found.has_features = true;
                }
                "crs" if self.is_root => {
                    let value: serde_json::Value = members.next_value()?;
                    self.file.system = value["properties"]["name"].as_str().map(str::to_string);
                }
                _ => drop(members.next_value::<IgnoredAny>()?),
            }
        }
        Ok(found)
    }
}

/// Reads a list of geometries, or enters a list of features.
struct Objects<'a> {
    file: &'a mut File,
    are_features: bool,
}

impl<'de> DeserializeSeed<'de> for Objects<'_> {
    type Value = Vec<Found>;

    fn deserialize<D: Deserializer<'de>>(self, input: D) -> JsonResult<Vec<Found>, D::Error> {
        input.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Objects<'_> {
    type Value = Vec<Found>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.are_features { "a list of features" } else { "a list of geometries" })
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> JsonResult<Vec<Found>, A::Error> {
        let mut objects = Vec::new();
        while let Some(object) = items.next_element_seed(Object { file: &mut *self.file, is_root: false })? {
            if self.are_features {
                object.finish(self.file).map_err(A::Error::custom)?;
                self.file.feature += 1;
            } else {
                objects.push(object);
            }
        }
        Ok(objects)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn feature(geometry: &str) -> String {
        format!(r#"{{"type":"Feature","properties":{{"a":[1,{{}}]}},"geometry":{geometry}}}"#)
    }

    fn collection(geometries: &[&str]) -> String {
        let features: Vec<String> = geometries.iter().map(|geometry| feature(geometry)).collect();
        format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(","))
    }

    #[test]
    fn all_geometries_are_lines() {
        let text = collection(&[
            r#"{"coordinates":[[0,0,7],[1,2,null],[2,2]],"type":"LineString"}"#,
            "null",
            r#"{"type":"MultiLineString","coordinates":[[[0,0],[1,1]],[],[[5,5],[6,6]]]}"#,
            r#"{"type":"MultiPolygon","coordinates":[[[[0,0],[1,0],[0,1],[0,0]]],[],[[[2,2],[3,2],[2,3],[2,2]]]]}"#,
            r#"{"type":"GeometryCollection","geometries":[{"type":"Point","coordinates":[8,9,1]},
                {"type":"Polygon","coordinates":[[[0,0],[1,0],[0,1],[0,0]],[[0,0],[1,0],[0,1],[0,0]]]}]}"#,
            r#"{"type":"MultiPoint","coordinates":[[1,1],[2,2]]}"#,
            r#"{"type":"LineString","coordinates":[]}"#,
        ]);
        let lines = read(text.as_bytes(), &Reading::default()).unwrap().lines;
        assert_eq!(lines[0].vertices, [[0.0, 0.0], [1.0, 2.0], [2.0, 2.0]]);
        assert_eq!(lines[0].elevations, [Some(7.0), None, None]);
        assert_eq!((&lines[2].position[..], lines[2].vertices[1]), ("feature 2", [6.0, 6.0]));
        let polygons: Vec<Option<u32>> = lines.iter().map(|line| line.polygon).collect();
        assert_eq!(polygons, [None, None, None, Some(0), Some(1), None, Some(2), Some(2), None, None]);
        assert_eq!(lines[5].elevations, [Some(1.0)]);
        let alone = read(
            "\u{feff} {\"type\":\"LineString\",\"coordinates\":[[0,1],[2,3]]} ".as_bytes(),
            &Reading::default(),
        )
        .unwrap();
        assert_eq!((alone.lines.len(), alone.system.crs), (1, Crs::Unknown));
    }

    #[test]
    fn the_system_is_that_of_the_member_crs() {
        let of = |name: &str| {
            let line = r#"{"type":"LineString","coordinates":[[0,1],[2,3]]}"#;
            let crs = format!(r#""crs":{{"type":"name","properties":{{"name":"{name}"}}}}"#);
            read(
                format!(r#"{{"type":"FeatureCollection",{crs},"features":[{}]}}"#, feature(line)).as_bytes(),
                &Reading::default(),
            )
        };
        let name = |name: &str| crate::crs::name(&of(name).unwrap().system.crs).unwrap();
        assert_eq!(name("urn:ogc:def:crs:EPSG::25832"), "EPSG:25832");
        assert_eq!(name("EPSG:2991"), "EPSG:2991");
        assert_eq!(name("urn:ogc:def:crs:OGC:1.3:CRS84"), "EPSG:4326");
        assert!(of("urn:ogc:def:crs:EPSG::1").is_err() && of("mine").is_err());
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place() {
        for (text, part) in [
            ("{", "cut off"),
            ("{]", "not JSON: "),
            (r#"{"type":"Topology"}"#, "\"Topology\" is no geometry"),
            (&collection(&[]), "found no lines"),
            (r#"{"type":"FeatureCollection"}"#, "a collection has no features"),
            (r#"{"type":"Point","coordinates":[1]}"#, "two numbers"),
            (r#"{"type":"Point"}"#, "Point has no coordinates"),
            (
                &collection(&["null", r#"{"type":"LineString","coordinates":[1,2]}"#]),
                "feature 1: coordinates of",
            ),
            (r#"{"type":"LineString","coordinates":[[1,"a"]]}"#, "not GeoJSON: "),
            (r#"{"type":"LineString","coordinates":[[1,2],[[1,2]]]}"#, "lists of different depth"),
            (r#"{"type":"LineString","coordinates":[[1,2],[1e999,2]]}"#, "out of range"),
            (r#"{"type":"LineString","coordinates":[[null,2],[1,2]]}"#, "feature 0: vertex 0 is at NaN, 2"),
            (&format!("{}{}", r#"{"type":"Polygon","coordinates":"#, "[".repeat(1000)), "lists in lists"),
            (r#"{"type":"LineString","coordinates":[[1,2],[1,3]]} x"#, "not JSON"),
        ] {
            let message = read(text.as_bytes(), &Reading::default()).unwrap_err().to_string();
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}

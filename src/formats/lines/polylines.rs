//! Polylines along which splines are not smooth, and corner points: lines of text, or GeoJSON.

use std::io::Read;

use serde_json::Value;

use crate::detect::read_head;
use crate::lines::geojson_polygons::{
    array, for_each_feature, geometry_of, is_json, member, parse, position, read_rest, type_of,
};
use crate::text::lines::quote;
use crate::text::words::{finite, for_each_line_at};
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::BREAKLINE_VERTICES_MAX;
use spmesh_stream::model::points::Point2;

/// The role of a polyline in a spline, as in the features of configurations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PolylineKind {
    /// Each of its vertices is a sharp corner.
    Corner,
    /// A crease that is sharp up to its ends.
    Crease,
    /// A crease that is smooth at its ends.
    SmoothCrease,
    /// Values along the polyline are interpolated linearly.
    Linear,
}

/// A polyline with its role.
#[derive(Debug, Clone, PartialEq)]
pub struct Polyline {
    /// Role in a spline.
    pub kind: PolylineKind,
    /// Its vertices, in world coordinates.
    pub vertices: Vec<Point2>,
    /// Position in the input, for messages.
    pub position: String,
}

const NAMES: [(&str, PolylineKind); 4] = [
    ("corner", PolylineKind::Corner),
    ("crease", PolylineKind::Crease),
    ("smooth-crease", PolylineKind::SmoothCrease),
    ("linear", PolylineKind::Linear),
];

/// The property of GeoJSON features that states the role.
const PROPERTY: &str = "spline";

/// Reads text or GeoJSON. A line of text is a word, `corner`, `crease`, `smooth-crease` or `linear`, and
/// coordinates X Y X Y ... In GeoJSON, points are corners, and lines and rings of polygons are creases,
/// unless a feature has a property `spline` with one of these words.
///
/// Coordinates of GeoJSON are not transformed; third coordinates are ignored.
///
/// # Errors
/// If reading fails, a line or geometry is not of these forms, or there is none at all.
pub fn read_polylines(mut input: impl Read) -> Result<Vec<Polyline>> {
    let head = read_head(&mut input).map_err(|e| Error::io("reading", e))?;
    let polylines = if is_json(&head) {
        of_json(&read_rest(input, head, "write the lines as text")?)?
    } else {
        of_text(head.chain(input))?
    };
    if polylines.is_empty() {
        return Err(Error::malformed("found no polyline"));
    }
    polylines.iter().try_for_each(|polyline| polyline.check().map_err(|e| e.at(&polyline.position)))?;
    Ok(polylines)
}

impl Polyline {
    fn check(&self) -> Result<()> {
        let (found, needed) = (self.vertices.len(), if self.kind == PolylineKind::Corner { 1 } else { 2 });
        if found < needed {
            return Err(Error::malformed(format!("found {found} vertices, expected {needed} at least")));
        }
        if self.kind != PolylineKind::Corner && self.vertices.windows(2).any(|edge| edge[0] == edge[1]) {
            return Err(Error::malformed("two consecutive vertices are at one place"));
        }
        Ok(())
    }
}

fn kind_of(name: &[u8]) -> Result<PolylineKind> {
    let known = NAMES.iter().find(|(known, _)| known.as_bytes() == name);
    known.map(|&(_, kind)| kind).ok_or_else(|| {
        Error::malformed(format!("found {}, expected corner, crease, smooth-crease or linear", quote(name)))
    })
}

fn of_text(input: impl Read) -> Result<Vec<Polyline>> {
    let mut polylines = Vec::new();
    let mut count = 0;
    for_each_line_at(input, |number, words| {
        let kind = kind_of(words[0])?;
        let numbers = words[1..].iter().map(|word| finite(word)).collect::<Result<Vec<f64>>>()?;
        if numbers.len() % 2 != 0 {
            let found = numbers.len();
            return Err(Error::malformed(format!("found {found} coordinates, expected pairs of x and y")));
        }
        let vertices: Vec<Point2> = numbers.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
        count += vertices.len();
        if count > BREAKLINE_VERTICES_MAX {
            return Err(Error::malformed(format!("more than {BREAKLINE_VERTICES_MAX} vertices")));
        }
        let position = format!("line {number}");
        polylines.push(Polyline { kind, vertices, position });
        Ok(())
    })?;
    Ok(polylines)
}

fn of_json(bytes: &[u8]) -> Result<Vec<Polyline>> {
    let mut polylines = Vec::new();
    for_each_feature(&parse(bytes)?, |feature| {
        let word = member(member(feature, "properties"), PROPERTY).as_str();
        let kind = word.map(|word| kind_of(word.as_bytes())).transpose()?;
        of_geometry(geometry_of(feature), kind, &mut polylines)
    })?;
    Ok(polylines)
}

fn of_geometry(geometry: &Value, kind: Option<PolylineKind>, polylines: &mut Vec<Polyline>) -> Result<()> {
    if type_of(geometry) == "GeometryCollection" {
        let parts = array(member(geometry, "geometries"))?;
        return parts.iter().try_for_each(|part| of_geometry(part, kind, polylines));
    }
    // Nesting depth of the lists around positions, and the default role.
    let (levels, own) = match type_of(geometry) {
        "Point" => (0, PolylineKind::Corner),
        "MultiPoint" => (1, PolylineKind::Corner),
        "LineString" => (1, PolylineKind::Crease),
        "MultiLineString" | "Polygon" => (2, PolylineKind::Crease),
        "MultiPolygon" => (3, PolylineKind::Crease),
        other => return Err(Error::malformed(format!("{other:?} is no geometry of GeoJSON"))),
    };
    of_coordinates(member(geometry, "coordinates"), levels, kind.unwrap_or(own), polylines)
}

fn of_coordinates(
    value: &Value,
    levels: usize,
    kind: PolylineKind,
    polylines: &mut Vec<Polyline>,
) -> Result<()> {
    let vertices = match levels {
        0 => vec![position(value)?],
        1 => array(value)?.iter().map(position).collect::<Result<_>>()?,
        _ => {
            let mut parts = array(value)?.iter();
            return parts.try_for_each(|part| of_coordinates(part, levels - 1, kind, polylines));
        }
    };
    polylines.push(Polyline { kind, vertices, position: format!("polyline {}", polylines.len()) });
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<(PolylineKind, Vec<Point2>)>> {
        let polylines = read_polylines(text.as_bytes())?;
        Ok(polylines.into_iter().map(|polyline| (polyline.kind, polyline.vertices)).collect())
    }

    #[test]
    fn lines_of_text_have_pairs() {
        let expected = vec![
            (PolylineKind::Crease, vec![[0.0, 1.0], [2.5, -3.0]]),
            (PolylineKind::Corner, vec![[4.0, 4.0]]),
            (PolylineKind::SmoothCrease, vec![[0.0, 0.0], [1.0, 1.0], [2.0, 1.0]]),
        ];
        assert_eq!(
            read("# ridges\ncrease 0 1 2.5 -3\ncorner 4,4\nsmooth-crease 0 0, 1 1, 2 1\n").unwrap(),
            expected
        );
        for (text, part) in [
            ("", "no polyline"),
            ("# one\ncrease 0 0\n", "line 2: found 1 vertices, expected 2"),
            ("crease 0 0 1\n", "line 1: found 3 coordinates"),
            ("corner 0 0\ncrease 0 0 0 0\n", "line 2: two consecutive"),
            ("ridge 0 0 1 1\n", "line 1: found \"ridge\""),
            ("crease 0 0 1 inf\n", "finite"),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(part), "{text}: {message}");
        }
    }

    #[test]
    fn geometries_of_json_are_polylines() {
        let feature = |geometry: &str, properties: &str| {
            format!("{{\"type\":\"Feature\",\"geometry\":{geometry},\"properties\":{properties}}}")
        };
        let line = r#"{"type":"LineString","coordinates":[[0,0,7],[1,2,7]]}"#;
        let ring =
            r#"{"type":"Polygon","coordinates":[[[0,0],[1,0],[0,1],[0,0]],[[2,2],[3,2],[2,3],[2,2]]]}"#;
        let point = r#"{"type":"Point","coordinates":[5,6.5]}"#;
        let all = [feature(line, "{\"spline\":\"linear\"}"), feature(ring, "null"), feature(point, "{}")];
        let text = format!(" {{\"type\":\"FeatureCollection\",\"features\":[{}]}}", all.join(","));
        let found = read(&text).unwrap();
        assert_eq!(found[0], (PolylineKind::Linear, vec![[0.0, 0.0], [1.0, 2.0]]));
        assert_eq!((found[1].0, found[1].1.len(), found[2].1[0]), (PolylineKind::Crease, 4, [2.0, 2.0]));
        assert_eq!(found[3], (PolylineKind::Corner, vec![[5.0, 6.5]]));
        assert_eq!(read(line).unwrap(), [(PolylineKind::Crease, vec![[0.0, 0.0], [1.0, 2.0]])]);
        for (text, part) in [
            ("{", "not JSON"),
            (r#"{"type":"Topology"}"#, "feature 0: \"Topology\" is no geometry"),
            (r#"{"type":"FeatureCollection","features":[]}"#, "no polyline"),
            (r#"{"type":"Point","coordinates":[1]}"#, "two numbers"),
            (r#"{"type":"Point"}"#, "no list"),
            (&feature(point, "{\"spline\":\"ridge\"}"), "found \"ridge\""),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}

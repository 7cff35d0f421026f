//! Masks: polygons from GeoJSON or WKT.

use std::io::Read;

use serde_json::Value;

use crate::detect::read_head;
use crate::lines::geojson_polygons::{
    array, for_each_feature, geometry_of, is_json, member, parse, position, read_rest, type_of,
};
use crate::lines::wkt_polygons;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::points::Point2;

/// A polygon: its rings, by the even-odd rule. A ring does not repeat its first vertex at the end.
pub type Polygon = Vec<Vec<Point2>>;

/// An area of the plane: everything inside or on the border of one of its polygons, in world coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Mask {
    /// The polygons, at least one.
    pub polygons: Vec<Polygon>,
}

impl Mask {
    /// All edges, with the number of their polygon; those of one polygon in a row.
    pub fn edges<'a>(&'a self) -> impl Iterator<Item = (u32, [Point2; 2])> + 'a {
        (0..).zip(&self.polygons).flat_map(|(number, polygon)| {
            let ends = move |ring: &'a Vec<Point2>| {
                let next = ring.iter().cycle().skip(1);
                ring.iter().zip(next).map(move |(&from, &to)| (number, [from, to]))
            };
            polygon.iter().flat_map(ends)
        })
    }
}

/// Reads polygons from GeoJSON (polygons, multipolygons, collections and features of them) or WKT (any number
/// of `POLYGON` and `MULTIPOLYGON`). Third coordinates are ignored.
///
/// # Errors
/// If reading fails; malformed, with the feature or the line, if there is something else, a ring is not closed
/// or has fewer than three vertices, a coordinate is not finite, or there is no polygon.
pub fn read_mask(mut input: impl Read) -> Result<Mask> {
    let head = read_head(&mut input).map_err(|e| Error::io("reading", e))?;
    let is_json = is_json(&head);
    let bytes = read_rest(input, head, "simplify the polygons")?;
    let mut polygons = Vec::new();
    if is_json {
        for_each_feature(&parse(&bytes)?, |feature| of_geometry(geometry_of(feature), &mut polygons))?;
    } else {
        polygons = wkt_polygons::polygons(&bytes)?;
    }
    if polygons.is_empty() {
        return Err(Error::malformed("no polygon: a mask needs one at least"));
    }
    Ok(Mask { polygons })
}

fn of_geometry(geometry: &Value, polygons: &mut Vec<Polygon>) -> Result<()> {
    let coordinates = member(geometry, "coordinates");
    match type_of(geometry) {
        "GeometryCollection" => {
            array(member(geometry, "geometries"))?.iter().try_for_each(|part| of_geometry(part, polygons))
        }
        "Polygon" => of_rings(coordinates, polygons),
        "MultiPolygon" => array(coordinates)?.iter().try_for_each(|part| of_rings(part, polygons)),
        "" => Err(Error::malformed("found no geometry, expected a polygon")),
        other => Err(Error::malformed(format!("found {other:?}, expected a polygon or a multipolygon"))),
    }
}

fn of_rings(rings: &Value, polygons: &mut Vec<Polygon>) -> Result<()> {
    let ring = |ring: &Value| closed(array(ring)?.iter().map(position).collect::<Result<_>>()?);
    let rings = array(rings)?.iter().enumerate();
    let polygon: Polygon =
        rings.map(|(number, value)| ring(value).map_err(|e| of_ring(&e, number))).collect::<Result<_>>()?;
    // A polygon without rings is empty.
    polygons.extend((!polygon.is_empty()).then_some(polygon));
    Ok(())
}

/// The error of a ring, with its number.
pub(crate) fn of_ring(error: &Error, number: usize) -> Error {
    Error::malformed(format!("ring {number}: {error}"))
}

/// The vertices of a ring that repeats its first vertex at the end, without the repetition.
pub(crate) fn closed(mut vertices: Vec<Point2>) -> Result<Vec<Point2>> {
    if let Some([x, y]) = vertices.iter().find(|at| !at.iter().all(|coordinate| coordinate.is_finite())) {
        return Err(Error::malformed(format!("the coordinates {x}, {y} are not finite")));
    }
    match (vertices.first(), vertices.last()) {
        (Some(first), Some(last)) if first != last => {
            let ([x, y], [u, v]) = (first, last);
            let what =
                format!("it starts at {x}, {y} and ends at {u}, {v}: repeat its first position at the end");
            Err(Error::malformed(what))
        }
        _ if vertices.len() < 4 => {
            let found = vertices.len();
            Err(Error::malformed(format!(
                "found {found} positions, expected 4 at least: the first again at the end"
            )))
        }
        _ => {
            vertices.pop();
            Ok(vertices)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &str = "[[0,0],[4,0,9],[4,4],[0,4],[0,0]]";
    const HOLE: &str = "[[1,1],[2,1],[1,2],[1,1]]";

    fn square() -> Vec<Point2> {
        vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]
    }

    fn hole() -> Vec<Point2> {
        vec![[1.0, 1.0], [2.0, 1.0], [1.0, 2.0]]
    }

    #[test]
    fn json_and_wkt_say_the_same() {
        let polygon = format!(r#"{{"type":"Polygon","coordinates":[{SQUARE},{HOLE}]}}"#);
        let multi = format!(r#"{{"type":"MultiPolygon","coordinates":[[{SQUARE}],[{HOLE}]]}}"#);
        let collection = format!(
            r#"{{"type":"FeatureCollection","features":[{{"type":"Feature","geometry":{polygon}}},{{"type":"Feature","geometry":{multi}}}]}}"#
        );
        let read = |text: &str| read_mask(text.as_bytes()).unwrap().polygons;
        let one = vec![square(), hole()];
        assert_eq!(read(&polygon), std::slice::from_ref(&one));
        assert_eq!(read(&collection), [one.clone(), vec![square()], vec![hole()]]);
        let wkt = "POLYGON((0 0,4 0,4 4,0 4,0 0),(1 1,2 1,1 2,1 1))";
        assert_eq!(read(wkt), std::slice::from_ref(&one));
        assert_eq!(
            read("SRID=2154;polygon z (( 0 0 7, 4 0 7, 4 4 7, 0 4 7, 0 0 7 ))\nPolygon EMPTY\n"),
            [vec![square()]]
        );
        let multi = "MULTIPOLYGON (((0 0,4 0,4 4,0 4,0 0)),\n((1 1,2 1,1 2,1 1)))";
        assert_eq!(read(multi), [vec![square()], vec![hole()]]);
        // Some editors put a byte order mark before the text.
        assert_eq!(read(&format!("\u{feff}{polygon}")), std::slice::from_ref(&one));
        assert_eq!(read(&format!("\u{feff}{wkt}")), std::slice::from_ref(&one));
        let edges = Mask { polygons: vec![vec![hole()]] };
        let edges: Vec<_> = edges.edges().map(|(number, [from, _])| (number, from)).collect();
        assert_eq!(edges, [(0, [1.0, 1.0]), (0, [2.0, 1.0]), (0, [1.0, 2.0])]);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place() {
        let feature = |geometry: &str| {
            let square = format!(r#"{{"type":"Polygon","coordinates":[{SQUARE}]}}"#);
            let feature = |geometry: &str| format!(r#"{{"type":"Feature","geometry":{geometry}}}"#);
            let features = [feature(&square), feature(geometry)].join(",");
            format!(r#"{{"type":"FeatureCollection","features":[{features}]}}"#)
        };
        for (text, part) in [
            ("", "no polygon"),
            ("{", "not JSON"),
            (
                &feature(r#"{"type":"Point","coordinates":[1,2]}"#),
                "feature 1: found \"Point\", expected a polygon",
            ),
            (&feature("null"), "feature 1: found no geometry"),
            (
                &feature(r#"{"type":"Polygon","coordinates":[[[0,0],[1,0],[1,1],[5,6]]]}"#),
                "feature 1: ring 0: it starts at 0, 0 and ends at 5, 6",
            ),
            (
                &feature(r#"{"type":"Polygon","coordinates":[[[0,0],[1,0],[0,0]]]}"#),
                "feature 1: ring 0: found 3 positions, expected 4",
            ),
            (&feature(r#"{"type":"Polygon","coordinates":[[[0,0],[1],[0,0]]]}"#), "two numbers"),
            (r#"{"type":"FeatureCollection","features":[]}"#, "no polygon"),
            ("POLYGON EMPTY", "no polygon"),
            ("POLYGON((0 0,1 0,1 1,0 0)", "line 1: found the end of the file, expected , or )"),
            ("\n\nPOLYGON((0 0,1 0,\nx 1,0 0))", "line 4: found \"x\", expected a finite number"),
            ("POLYGON((0 0,1,1 1,0 0))", "line 1: found 1 coordinates, expected 2 at least"),
            (
                "POLYGON((0 0,1 0,1 1,0 0))\nPOINT(1 2)",
                "line 2: found \"POINT\", expected POLYGON or MULTIPOLYGON",
            ),
            ("POLYGON((0 0,1 0,1 1,0 2))", "line 1: ring 0: it starts at 0, 0 and ends at 0, 2"),
            ("0 0\n1 0\n", "line 1: found \"0\", expected POLYGON"),
        ] {
            let message = read_mask(text.as_bytes()).unwrap_err().to_string();
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}

//! Polylines along which splines are not smooth, and corner points.

use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use crate::lines::collect::Shape;
use crate::lines::systems::LineSystem;
use crate::lines::{Breakline, Breaklines, Collector, Properties, Reading, check_text, read};
use crate::source::origin::name_of;
use crate::text::lines::quote;
use crate::text::words::{finite, for_each_line_at};
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::BREAKLINE_VERTICES_MAX;
use spmesh_stream::Crs;
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

/// Reads the polylines of a file, and what it says about their system and its layers. A line of text is a
/// word, `corner`, `crease`, `smooth-crease` or `linear`, and coordinates X Y X Y ... Other formats are those
/// of [`super::read_breaklines`]: points are corners, and lines and rings of polygons are creases, unless a
/// feature has a property `spline` with one of these words.
///
/// Coordinates are not transformed; third coordinates are ignored.
///
/// # Errors
/// If reading fails, a line or geometry is not of these forms, or there is none at all.
pub fn read_polylines(path: &Path) -> Result<(Vec<Polyline>, LineSystem, Option<String>)> {
    let of_text =
        |head: &[u8], input: &mut dyn Read, _: &Reading| check_text(head).and_then(|()| text(input));
    let name = |error: Error| error.of_input(name_of(path));
    let file = read(path, of_text, &Reading::default()).map_err(name)?;
    file.check_properties().map_err(name)?;
    let polylines = polylines(&file.lines).map_err(|error| name(file.noting_layers(error)))?;
    Ok((polylines, file.system, file.layers))
}

fn polylines(lines: &[Breakline]) -> Result<Vec<Polyline>> {
    check_count(lines.iter().map(|line| line.vertices.len()).sum())?;
    // The points of a multipoint are vertices of one polyline.
    let same = lines.chunk_by(|a, b| a.is_point && Arc::ptr_eq(&a.position, &b.position));
    same.map(|lines| Polyline::new(lines).map_err(|error| error.at(&*lines[0].position))).collect()
}

fn check_count(vertices: usize) -> Result<()> {
    if vertices <= BREAKLINE_VERTICES_MAX {
        return Ok(());
    }
    Err(Error::malformed(format!("more than {BREAKLINE_VERTICES_MAX} vertices")))
}

impl Polyline {
    fn new(lines: &[Breakline]) -> Result<Polyline> {
        let Breakline { is_point, properties, position, .. } = &lines[0];
        let own = if *is_point { PolylineKind::Corner } else { PolylineKind::Crease };
        let kind = properties.spline.as_deref().map_or(Ok(own), |word| kind_of(word.as_bytes()))?;
        let vertices = lines.iter().flat_map(|line| line.vertices.iter().copied()).collect();
        let polyline = Polyline { kind, vertices, position: position.to_string() };
        polyline.check().map(|()| polyline)
    }

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

/// Reads lines of text: the words are properties.
fn text(input: impl Read) -> Result<Breaklines> {
    let mut lines = Collector::new(&Reading::default());
    let mut count = 0;
    for_each_line_at(input, |number, words| {
        let kind = kind_of(words[0])?;
        let numbers = words[1..].iter().map(|word| finite(word)).collect::<Result<Vec<f64>>>()?;
        if numbers.len() % 2 != 0 {
            let found = numbers.len();
            return Err(Error::malformed(format!("found {found} coordinates, expected pairs of x and y")));
        }
        let vertices: Vec<[f64; 3]> = numbers.chunks_exact(2).map(|at| [at[0], at[1], f64::NAN]).collect();
        if vertices.is_empty() {
            Polyline { kind, vertices: Vec::new(), position: String::new() }.check()?;
        }
        count += vertices.len();
        check_count(count)?;
        let spline = Some(String::from_utf8_lossy(words[0]).into_owned());
        lines.feature(Properties { spline, ..Properties::default() });
        lines.add(Shape::Line, &vertices, || format!("line {number}"))
    })?;
    lines.finish(Crs::Unknown)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lines::geojson;

    fn read(bytes: &str) -> Result<Vec<(PolylineKind, Vec<Point2>)>> {
        let is_json = geojson::is_json(bytes.as_bytes());
        let file = if is_json {
            geojson::read(bytes.as_bytes(), &Reading::default())
        } else {
            text(bytes.as_bytes())
        }?;
        Ok(polylines(&file.lines)?.into_iter().map(|polyline| (polyline.kind, polyline.vertices)).collect())
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
            ("", "no lines"),
            ("crease\n", "line 1: found 0 vertices, expected 2"),
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
        let points = r#"{"type":"MultiPoint","coordinates":[[0,0],[1,2]]}"#;
        let vertices = || vec![[0.0, 0.0], [1.0, 2.0]];
        assert_eq!(read(points).unwrap(), [(PolylineKind::Corner, vertices())]);
        let along = feature(points, "{\"spline\":\"smooth-crease\"}");
        assert_eq!(read(&along).unwrap(), [(PolylineKind::SmoothCrease, vertices())]);
        for (text, part) in [
            ("{", "not JSON"),
            (r#"{"type":"Topology"}"#, "feature 0: \"Topology\" is no geometry"),
            (r#"{"type":"FeatureCollection","features":[]}"#, "found no lines"),
            (r#"{"type":"Point","coordinates":[1]}"#, "two numbers"),
            (r#"{"type":"Point"}"#, "Point has no coordinates"),
            (&feature(point, "{\"spline\":\"ridge\"}"), "found \"ridge\""),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}

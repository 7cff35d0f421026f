//! The program at the end of a pipeline, on a real tile.

use std::collections::{BTreeMap, HashMap};

use serde_json::Value;
use spmesh_terrain::contours::LineFormat;

use super::{Line, parse};
use crate::dem::pipelines::{mesh, triangles};
use crate::programs::{Folder, outcome, run};

/// Coordinates are rounded to multiples of 1e-4, which moves a point by less than this.
const ROUNDING: f64 = 1.1e-4;

fn length([p, q]: [[f64; 2]; 2]) -> f64 {
    (q[0] - p[0]).hypot(q[1] - p[1])
}

/// The segment of a level in a triangle, in f64; higher ground is on the left.
fn segment(triangle: [[f64; 3]; 3], level: f64) -> Option<[[f64; 2]; 2]> {
    let (mut from, mut to) = (None, None);
    for i in 0..3 {
        let (p, q) = (triangle[i], triangle[(i + 1) % 3]);
        let at = [0, 1].map(|axis| p[axis] + (q[axis] - p[axis]) * (level - p[2]) / (q[2] - p[2]));
        match (p[2] >= level, q[2] >= level) {
            (true, false) => from = Some(at),
            (false, true) => to = Some(at),
            _ => {}
        }
    }
    Some([from?, to?])
}

/// Lines by elevation, in integer tenths.
fn by_level(lines: Vec<Line>) -> BTreeMap<i64, Vec<Line>> {
    let mut levels: BTreeMap<i64, Vec<Line>> = BTreeMap::new();
    lines
        .into_iter()
        .for_each(|line| levels.entry((line.elevation * 10.0).round() as i64).or_default().push(line));
    levels
}

#[test]
fn a_real_tile_has_the_segments_of_its_triangles() {
    let mesh = mesh();
    let output = run("spdem", &["--contours", "2.5", "--contour-base", "0.1", "--stats=json", "-q"], &mesh);
    let (code, message) = outcome(&output);
    assert_eq!(code, Some(0), "{message}");
    let stats: Value = serde_json::from_str(&message).unwrap();
    let lines = parse(&output.stdout, LineFormat::GeoJson);
    assert_eq!(stats["lines"], lines.len());
    assert_eq!(stats["output_bytes"], output.stdout.len());
    let (levels, triangles) = (by_level(lines), triangles(&mesh));
    assert_eq!(stats["levels"], levels.len());
    assert!(levels.len() > 10);
    for (level, lines) in levels {
        let expected: Vec<_> =
            triangles.iter().filter_map(|&triangle| segment(triangle, level as f64 / 10.0)).collect();
        let found: Vec<_> = lines.iter().flat_map(Line::segments).collect();
        let total = |segments: &[[[f64; 2]; 2]]| segments.iter().copied().map(length).sum::<f64>();
        let difference = (total(&expected) - total(&found)).abs();
        assert!(difference < ROUNDING * expected.len() as f64, "{level}: {difference}");
        // Each expected segment is found, except segments that rounding turns into a point.
        let cell = |[p, _]: [[f64; 2]; 2]| p.map(|value| (value * 100.0).round() as i64);
        let mut places: HashMap<[i64; 2], Vec<[[f64; 2]; 2]>> = HashMap::new();
        found.iter().for_each(|&segment| places.entry(cell(segment)).or_default().push(segment));
        for &[p, q] in expected.iter().filter(|&&segment| length(segment) > 2.0 * ROUNDING) {
            let [x, y] = cell([p, q]);
            let near = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [x + i, y + j]));
            let is_same = |&[r, s]: &[[f64; 2]; 2]| length([p, r]) < ROUNDING && length([q, s]) < ROUNDING;
            let is_found = near.filter_map(|cell| places.get(&cell)).flatten().any(is_same);
            assert!(is_found, "{level}: {:?}", [p, q]);
        }
        assert!(found.len() <= expected.len(), "{level}");
    }
}

#[test]
fn files_say_where_they_are() {
    let (folder, mesh) = (Folder::new(), mesh());
    let mut all = Vec::new();
    for (name, format, said) in [
        ("lines.geojson", LineFormat::GeoJson, "EPSG:2975, which the file states"),
        ("lines.GEOJSONL", LineFormat::GeoJsonLines, "say -a_srs EPSG:2975"),
    ] {
        let output = run("spdem", &["--contours", "10", "--kill", "5", "-o", &folder.path(name)], &mesh);
        let (code, message) = outcome(&output);
        assert_eq!(code, Some(0), "{message}");
        assert!(message.contains(said) && message.contains(" rings) at "), "{message}");
        let text = std::fs::read(folder.path(name)).unwrap();
        all.push(parse(&text, format));
        if format == LineFormat::GeoJson {
            let collection: Value = serde_json::from_slice(&text).unwrap();
            assert_eq!(collection["crs"]["properties"]["name"], "urn:ogc:def:crs:EPSG::2975");
        }
    }
    assert!(all[0] == all[1] && all[0].iter().all(|line| line.elevation % 10.0 == 0.0));
    // Coordinates of the tile are multiples of 0.01; lines have at most two digits more.
    let has_digits =
        |value: f64| format!("{value}").split_once('.').is_none_or(|(_, digits)| digits.len() <= 4);
    assert!(all[0].iter().flat_map(|line| line.points.iter().flatten()).all(|&value| has_digits(value)));
}

#[test]
fn one_stream_has_one_file_and_another_order_the_same_lines() {
    let mesh = mesh();
    // Elevations are multiples of 0.01, so no vertex is on a level.
    let arguments = ["--contours", "2", "--contour-base", "0.005", "--format", "geojsonl"];
    let file = |mesh: &[u8]| run("spdem", &arguments, mesh).stdout;
    let text = file(&mesh);
    assert_eq!(file(&mesh), text);
    // OBJ does not finalize vertices, and has world coordinates.
    let obj = run("spconvert", &["--to", "obj"], &mesh).stdout;
    let other = file(&run("spconvert", &["--to", "spm"], &obj).stdout);
    let summary = |text: &[u8]| {
        let mut levels: BTreeMap<i64, [usize; 2]> = BTreeMap::new();
        for (level, lines) in by_level(parse(text, LineFormat::GeoJsonLines)) {
            levels.insert(level, [lines.len(), lines.iter().filter(|line| line.is_closed).count()]);
        }
        levels
    };
    let (ours, others) = (summary(&text), summary(&other));
    assert_eq!(ours.keys().collect::<Vec<_>>(), others.keys().collect::<Vec<_>>());
    // Rounding may turn a small ring into a point in one of the two files.
    for (level, [lines, rings]) in ours {
        let [other_lines, other_rings] = others[&level];
        assert_eq!(lines - rings, other_lines - other_rings, "{level}");
        assert!(lines.abs_diff(other_lines) <= 1 + lines / 50, "{level}: {lines} and {other_lines}");
    }
}

//! Lines inside of an outline or a mask, index lines and short lines.

use std::sync::Arc;

use spmesh_formats::source::Mask;
use spmesh_terrain::contours::{LineFormat, Options, contour};

use super::{Line, WHOLE, lines, options, try_lines};
use crate::dem::Mesh;
use serde_json::Value;
use spmesh_reference::sets::{Random, uniform};
use spmesh_stream::{Coordinates, StreamReader};

#[test]
fn lines_are_those_of_the_triangles_inside() {
    let mut random = Random::new(17);
    for round in 0..4 {
        let mesh = if round < 2 {
            Mesh::lake(&mut random)
        } else {
            Mesh::of(&mut random, &uniform(&mut Random::new(round), 90, 60))
        };
        for length in [2.0, 4.0, 8.0, 30.0] {
            let inside = mesh.inside(length * length).without_unused();
            let expected = inside.map(|inside| lines(&inside.stream(WHOLE), &options(100.0, 50.5)));
            let expected = expected.unwrap_or_default();
            let limited = Options { concave: Some(length), memory: 1 << 19, ..options(100.0, 50.5) };
            assert_eq!(lines(&mesh.stream(WHOLE), &limited), expected, "{round} {length}");
            let shuffled = mesh.shuffled(&mut random).stream(WHOLE);
            assert_eq!(lines(&shuffled, &limited), expected, "{round} {length}");
        }
    }
}

fn length(line: &Line) -> f64 {
    line.segments().map(|[p, q]| (q[0] - p[0]).hypot(q[1] - p[1])).sum()
}

#[test]
fn lines_are_cut_at_the_mask() {
    let mut random = Random::new(31);
    let mesh = Mesh::of(&mut random, &uniform(&mut Random::new(5), 300, 100));
    let stream = mesh.stream(Coordinates::F64);
    let all: f64 = lines(&stream, &options(50.0, 0.5)).iter().map(length).sum();
    for round in 0..10 {
        // A star around a place, with a hole.
        let count = if round < 5 { 7 } else { 1_000 };
        let mut star = |least: i64, most: i64| -> Vec<[f64; 2]> {
            let corner = |number: usize| {
                let angle = number as f64 / count as f64 * std::f64::consts::TAU;
                let far = random.integer(least, most) as f64;
                [50.0 + far * angle.cos(), 45.0 + far * angle.sin()]
            };
            (0..count).map(corner).collect()
        };
        let rings = vec![star(25, 60), star(5, 20)];
        let everything = vec![[-1e3, -1e3], [1e3, -1e3], [1e3, 1e3], [-1e3, 1e3]];
        let others = [vec![everything], rings.clone()].concat();
        let masked = |polygon: Vec<Vec<[f64; 2]>>| {
            let mask = Some(Arc::new(Mask { polygons: vec![polygon] }));
            lines(&stream, &Options { mask, ..options(50.0, 0.5) })
        };
        let (inside, outside) = (masked(rings), masked(others));
        assert!(inside.len() > 5 && outside.len() > 5);
        let [inside, outside] = [inside, outside].map(|lines| lines.iter().map(length).sum::<f64>());
        assert!((inside + outside - all).abs() < 1e-6 * all, "{round}: {inside} + {outside}, {all}");
    }
}

#[test]
fn every_fifth_line_is_an_index_line() {
    let mesh = Mesh::of(&mut Random::new(2), &uniform(&mut Random::new(5), 100, 100));
    let stream = mesh.stream(WHOLE);
    for (base, index) in [(0.0, 5), (3.0, 4)] {
        let mut text = Vec::new();
        let options = Options { index, ..options(10.0, base) };
        let mut reader = StreamReader::new(&stream[..], "mesh").unwrap();
        contour(&mut reader, &mut text, LineFormat::GeoJsonLines, &options, |_| {}).unwrap();
        for line in std::str::from_utf8(&text).unwrap().lines() {
            let feature: Value = serde_json::from_str(line).unwrap();
            let level = (feature["properties"]["elevation"].as_f64().unwrap() - base) / 10.0;
            let is_index = level.round() as i64 % i64::from(index) == 0;
            assert_eq!(feature["properties"]["index"], is_index, "{line}");
        }
    }
}

#[test]
fn short_lines_are_dropped() {
    let mesh = Mesh::of(&mut Random::new(2), &uniform(&mut Random::new(5), 200, 100));
    let stream = mesh.stream(WHOLE);
    let all = lines(&stream, &options(100.0, 0.5));
    for least in [1.0, 20.0, 100.0] {
        let (mut found, stats) =
            try_lines(&stream, &Options { min_length: Some(least), ..options(100.0, 0.5) }).unwrap();
        found.sort_by(|a, b| a.partial_cmp(b).unwrap());
        let expected: Vec<Line> = all.iter().filter(|line| length(line) >= least).cloned().collect();
        assert_eq!(found, expected);
        assert_eq!(stats.short as usize, all.len() - expected.len());
    }
}

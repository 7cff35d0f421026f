//! Lines and water that are read for a box alone: they are those of all lines there.

use std::collections::BTreeSet;
use std::path::PathBuf;

use serde_json::json;
use spmesh_base::random::Random;
use spmesh_pipeline::lines::{Lines, Options, Sources, Target, read};
use spmesh_pipeline::polygons::Polygons;
use spmesh_stream::{Coordinates, Crs};

use crate::programs::Folder;

type Place = [f64; 2];

/// Lines and shores that cross and touch, most of them in some places of a large country.
fn layers(random: &mut Random) -> [String; 2] {
    let (mut lines, mut water) = (Vec::new(), Vec::new());
    let feature = |kind: &str, properties: serde_json::Value, coordinates: serde_json::Value| json!({"type": "Feature", "properties": properties, "geometry": {"type": kind, "coordinates": coordinates}});
    let rounded = |at: f64| (at * 100.0).round() / 100.0;
    for number in 0..120 {
        let [x, y] = [0; 2].map(|_| 2000.0 * random.unit());
        let radius = 4.0 + 60.0 * random.unit().powi(3);
        let ring = |radius: f64| -> Vec<Place> {
            let at = |step: u32| f64::from(step) * std::f64::consts::TAU / 12.0;
            let mut ring: Vec<Place> = (0..12)
                .map(|step| [rounded(x + radius * at(step).cos()), rounded(y + radius * at(step).sin())])
                .collect();
            ring.push(ring[0]);
            ring
        };
        match number % 3 {
            0 => {
                water.push(feature("Polygon", json!({"level": 5}), json!([ring(radius), ring(radius / 3.0)])))
            }
            1 => {
                let line: Vec<[f64; 3]> = (0..4)
                    .map(|_| [0; 3].map(|_| 3.0 * radius * random.unit()))
                    .map(|[u, v, z]| [rounded(x + u), rounded(y + v), rounded(z)])
                    .collect();
                lines.push(feature("LineString", json!({}), json!(line)));
            }
            _ => lines.push(feature("LineString", json!({}), json!(ring(radius)))),
        }
    }
    // A river through all of it, whose box meets every other one, and a lake around a fifth.
    let bank = |side: f64| -> Vec<[f64; 3]> {
        (0..40)
            .map(|step| 50.0 * f64::from(step))
            .map(|x| [x, rounded(0.9 * x + 90.0 * (x / 150.0).sin() + side), rounded(40.0 - x / 100.0)])
            .collect()
    };
    let mut ring = bank(6.0);
    ring.extend(bank(-6.0).into_iter().rev());
    ring.push(ring[0]);
    water.push(feature("Polygon", json!({"river": "Aare"}), json!([ring])));
    water.push(feature(
        "Polygon",
        json!({"level": 3}),
        json!([[[1200.0, 0.0], [2000.0, 0.0], [2000.0, 700.0], [1200.0, 0.0]]]),
    ));
    [lines, water].map(|features| json!({"type": "FeatureCollection", "features": features}).to_string())
}

/// The vertices in a box with their elevations, and the segments that meet it, of all lines and of shores.
fn inside(found: &Lines, [min, max]: [Place; 2]) -> [BTreeSet<String>; 3] {
    let network = &found.network;
    let is_in = |place: &Place| (0..2).all(|axis| (min[axis]..=max[axis]).contains(&place[axis]));
    let meets = |ends: &[Place; 2]| {
        (0..2).all(|axis| {
            let (low, high) = (ends[0][axis].min(ends[1][axis]), ends[0][axis].max(ends[1][axis]));
            low <= max[axis] && high >= min[axis]
        })
    };
    let vertices = network.vertices.iter().filter(|vertex| is_in(&vertex.place));
    let segments = network.segments.iter().map(|segment| network.places(segment));
    let shores = found.water.edges(network).into_iter().map(|(_, ends)| ends);
    [
        vertices.map(|vertex| format!("{:?} {:?}", vertex.place, vertex.z)).collect(),
        segments.filter(meets).map(|ends| format!("{ends:?}")).collect(),
        shores.filter(meets).map(|ends| format!("{ends:?}")).collect(),
    ]
}

#[test]
fn lines_of_a_box_are_those_of_all_there() {
    let (folder, mut random) = (Folder::new(), Random::new(11));
    let grid = Coordinates::I32 { scale: [0.01; 3], offset: [0.0; 3] };
    let (mut left_out, mut crossings) = (0, 0);
    for round in 0..6 {
        let coordinates = if round % 3 == 0 { Coordinates::F64 } else { grid };
        let target = Target { coordinates, crs: Crs::Unknown, has_elevation: true };
        let unit = if coordinates == Coordinates::F64 { 1.0 } else { 100.0 };
        let [lines, water] = layers(&mut random);
        let [lines, water] = [("lines.geojson", lines), ("water.geojson", water)]
            .map(|(name, text)| [PathBuf::from(folder.write(name, text))]);
        let sources = Sources { lines: &lines, water: &water, ..Sources::default() };
        let all = read(&sources, &target, &Options::default()).expect("sound lines");
        let water_of = |found: &Lines| Polygons::of_edges(found.water.edges(&found.network).into_iter());
        let water_of_all = water_of(&all);
        for number in 0..16 {
            let [x, y, side] = [0; 3].map(|_| random.unit());
            // Half of the boxes are on the river.
            let min = [1850.0 * x, if number % 2 == 0 { 1850.0 * y } else { 1665.0 * x }];
            let reach = [min, min.map(|at| at + 10.0 + 120.0 * side)];
            let options = Options { reach: Some(reach), ..Options::default() };
            let some = read(&sources, &target, &options).expect("sound lines");
            let stored = reach.map(|corner| corner.map(|at| at * unit));
            let (found, expected) = (inside(&some, stored), inside(&all, stored));
            assert_eq!(found, expected, "round {round}, {reach:?}");
            let water_of_some = water_of(&some);
            for _ in 0..200 {
                let place =
                    [0, 1].map(|axis| stored[0][axis] + random.unit() * (stored[1][axis] - stored[0][axis]));
                assert_eq!(water_of_some.side(place), water_of_all.side(place), "{place:?}");
            }
            left_out += all.network.vertices.len() - some.network.vertices.len();
            crossings += found[1].len();
        }
    }
    assert!(left_out > 50_000 && crossings > 150, "{left_out} vertices left out, {crossings} segments");
}

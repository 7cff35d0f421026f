//! `spdem --bends`: a mesh of contour lines alone has no flat bends any more, and comes nearer to the ground.

use std::fs;

use serde_json::Value;
use spmesh_base::random::Random;
use spmesh_stream::{Event, LiveVertices, StreamReader};

use crate::programs::{Folder, assert_outcome, outcome, run};

const INTERVAL: f64 = 2.0;

fn ground([x, y]: [f64; 2]) -> f64 {
    40.0 + 12.0 * (x / 17.0).sin() * (y / 13.0).cos() + 0.1 * x
}

/// The triangles of a mesh, in the units of its grid.
fn triangles(mesh: &[u8]) -> Vec<[[f64; 3]; 3]> {
    let mut reader = StreamReader::new(mesh, "test").expect("a stream");
    let (mut live, mut found) = (LiveVertices::new(), Vec::new());
    while let Some(event) = reader.next_event().expect("a sound stream") {
        if let Event::Patch(patch) = event {
            let vertices = live.enter(&patch, |_, point| point).expect("known vertices");
            found.extend(patch.triangles().map(|triangle| triangle.map(|local| vertices[local as usize].1)));
        }
    }
    found
}

fn flat(triangles: &[[[f64; 3]; 3]]) -> u64 {
    triangles.iter().filter(|corners| corners.iter().all(|corner| corner[2] == corners[0][2])).count() as u64
}

/// The root of the mean square difference from the ground at centroids, weighed by areas, in metres.
fn error(triangles: &[[[f64; 3]; 3]]) -> f64 {
    let (mut sum, mut area) = (0.0, 0.0);
    for [a, b, c] in triangles {
        let [x, y, z] = [0, 1, 2].map(|axis| (a[axis] + b[axis] + c[axis]) / 3.0 * [1e-3, 1e-3, 1e-5][axis]);
        let size = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        sum += size * (z - ground([x, y])).powi(2);
        area += size;
    }
    (sum / area).sqrt()
}

fn succeed(program: &str, flags: &[&str], input: &[u8]) -> Vec<u8> {
    let output = run(program, flags, input);
    assert_eq!(outcome(&output).0, Some(0), "{program} {flags:?}: {}", outcome(&output).1);
    output.stdout
}

#[test]
fn bends_are_not_flat_with_the_places_in_them() {
    let folder = Folder::new();
    let mut random = Random::new(9);
    let place = |random: &mut Random| [0; 2].map(|_| 120.0 * random.unit());
    let text: String = (0..20_000)
        .map(|_| place(&mut random))
        .map(|[x, y]| format!("{x:.2} {y:.2} {:.2}\n", ground([x, y])))
        .collect();
    // So fine that no elevation in a bend is rounded to that of its line.
    let scale = ["--scale", "0.001,0.001,0.00001"];
    let of_points = succeed("spdelaunay2d", &[], &succeed("spfinalize", &scale, text.as_bytes()));
    let lines = folder.path("lines.geojson");
    succeed("spdem", &["--contours", "2", "--contour-base", "1", "-o", &lines], &of_points);
    let field = ["--z-field", "elevation"];
    let mesh = |more: &[&str]| {
        let flags = [&["--no-points", "--lines", &lines], more, &field, &scale].concat();
        let unconstrained = succeed("spdelaunay2d", &[], &succeed("spfinalize", &flags, b""));
        succeed("spconstrain", &[&["--lines", &lines][..], &field].concat(), &unconstrained)
    };
    let first = mesh(&[]);
    let places = folder.path("bends.geojson");
    let output = run("spdem", &["--bends", "-q", "--stats=json", "-o", &places], &first);
    let stats: Value = serde_json::from_str(&outcome(&output).1).expect("JSON");
    let count = |name: &str| stats[name].as_u64().expect("a count");
    let layer: Value = serde_json::from_slice(&fs::read(&places).unwrap()).unwrap();
    let features = layer["features"].as_array().unwrap();
    assert_eq!(features.len() as u64, count("places"));
    for feature in features {
        let [x, y, z] = [0, 1, 2].map(|axis| feature["geometry"]["coordinates"][axis].as_f64().unwrap());
        // Between two lines. Where the mesh ends, triangles between the ends of lines are far from the
        // ground.
        let is_inside = [x, y].iter().all(|at| (3.0..117.0).contains(at));
        assert!((z - 1.0) % INTERVAL != 0.0, "{feature}");
        assert!(!is_inside || (z - ground([x, y])).abs() < INTERVAL, "{feature}");
    }
    let second = mesh(&["--lines", &places]);
    let [before, after] = [triangles(&first), triangles(&second)];
    assert_eq!(flat(&before), count("flat"));
    assert!(count("in_bends") > 300 && count("bends") > 30, "{stats}");
    // What is left is on summits, in hollows and on passes, or as thin as the steps of the grid.
    assert!(flat(&after) * 5 < flat(&before) * 3, "{} of {}: {stats}", flat(&after), flat(&before));
    assert!(error(&after) < error(&before), "{} instead of {}", error(&after), error(&before));
    assert_outcome("spinfo", &["--audit"], &second, 0, "");
}

#[test]
fn meshes_without_lines_are_refused() {
    let points = succeed("spfinalize", &["-"], b"0 0 1\n10 0 1\n0 10 1\n10 10 1\n");
    let mesh = succeed("spdelaunay2d", &[], &points);
    assert_outcome("spdem", &["--bends"], &mesh, 2, "make it with spconstrain --lines");
    assert_outcome("spdem", &["--bends", "--contours", "5"], &mesh, 2, "cannot be used with");
}

//! The program at the end of a pipeline, on a real tile.

use std::fs::File;
use std::io::BufReader;

use serde_json::Value;
use tiff::decoder::Decoder;
use tiff::tags::Tag;

use super::values;
use crate::programs::{Folder, outcome, run, sample};

/// A real tile as a mesh stream.
pub fn mesh() -> Vec<u8> {
    let points = run("spfinalize", &["--cell-points", "3000", &sample("lareunion.laz")], &[]);
    assert!(points.status.success(), "{:?}", outcome(&points));
    let mesh = run("spdelaunay2d", &["--duplicates", "lowest"], &points.stdout);
    assert!(mesh.status.success(), "{:?}", outcome(&mesh));
    mesh.stdout
}

/// Corners of triangles in world coordinates, from the OBJ of a mesh.
pub fn triangles(mesh: &[u8]) -> Vec<[[f64; 3]; 3]> {
    let obj = String::from_utf8(run("spconvert", &["--to", "obj"], mesh).stdout).unwrap();
    let numbers =
        |line: &str| -> Vec<f64> { line.split(' ').skip(1).map(|word| word.parse().unwrap()).collect() };
    let vertices: Vec<[f64; 3]> = obj
        .lines()
        .filter(|line| line.starts_with("v "))
        .map(|line| numbers(line).try_into().unwrap())
        .collect();
    let faces = obj.lines().filter(|line| line.starts_with("f ")).map(numbers);
    faces.map(|face| [0, 1, 2].map(|corner| vertices[face[corner] as usize - 1])).collect()
}

/// Gives the cells in a triangle their value by barycentric coordinates, in plain arithmetic.
fn fill(expected: &mut [f64], columns: usize, [left, top, step]: [f64; 3], [a, b, c]: [[f64; 3]; 3]) {
    let cross =
        |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let flat = |p: [f64; 3]| [p[0], p[1]];
    let ends = |axis: usize| {
        let all = [a[axis], b[axis], c[axis]];
        [all.into_iter().fold(f64::INFINITY, f64::min), all.into_iter().fold(f64::NEG_INFINITY, f64::max)]
    };
    let ([x0, x1], [y0, y1]) = (ends(0), ends(1));
    let rows = expected.len() / columns;
    let from = |place: f64| (place / step).floor().max(0.0) as usize;
    for row in from(top - y1)..(from(top - y0) + 1).min(rows) {
        for column in from(x0 - left)..(from(x1 - left) + 1).min(columns) {
            let at = [left + (column as f64 + 0.5) * step, top - (row as f64 + 0.5) * step];
            let all = cross(flat(a), flat(b), flat(c));
            let shares =
                [cross(at, flat(b), flat(c)), cross(flat(a), at, flat(c)), cross(flat(a), flat(b), at)]
                    .map(|part| part / all);
            if shares.iter().all(|&share| share >= -1e-9) {
                expected[row * columns + column] = shares[0] * a[2] + shares[1] * b[2] + shares[2] * c[2];
            }
        }
    }
}

#[test]
fn a_real_tile_has_the_elevations_of_its_triangles() {
    let mesh = mesh();
    let output = run("spdem", &["--step", "0.5", "--format", "asc", "--stats=json", "-q"], &mesh);
    let (code, message) = outcome(&output);
    assert_eq!(code, Some(0), "{message}");
    let stats: Value = serde_json::from_str(&message).unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let head: Vec<f64> =
        text.lines().take(5).map(|line| line.split(' ').nth(1).unwrap().parse().unwrap()).collect();
    let (columns, rows) = (head[0] as usize, head[1] as usize);
    let found = values(text.as_bytes());
    let place = [head[2], head[3] + rows as f64 * head[4], head[4]];
    let mut expected = vec![f64::NAN; found.len()];
    let triangles = triangles(&mesh);
    assert_eq!(stats["triangles"], triangles.len());
    triangles.into_iter().for_each(|triangle| fill(&mut expected, columns, place, triangle));
    let mut compared = 0;
    for (cell, (&found, &expected)) in found.iter().zip(&expected).enumerate() {
        if !expected.is_nan() {
            assert!((f64::from(found) - expected).abs() < 1e-3, "cell {cell}: {found}, expected {expected}");
            compared += 1;
        }
    }
    assert_eq!((stats["cells"].as_u64(), stats["known"].as_u64()), (Some(10_000), Some(compared)));
}

#[test]
fn files_say_where_they_are() {
    let (folder, mesh) = (Folder::new(), mesh());
    let [file, text] = ["terrain.tif", "terrain.asc"].map(|name| folder.path(name));
    for name in [&file, &text] {
        let output =
            run("spdem", &["--step", "2", "--kind", "hillshade", "--light", "300,40", "-o", name], &mesh);
        let (code, message) = outcome(&output);
        assert_eq!(code, Some(0), "{message}");
        assert!(message.starts_with("spdem: ") && message.contains(" cells of size 2"), "{message}");
    }
    let found = values(&std::fs::read(text).unwrap());
    assert!(found.iter().all(|value| value.is_nan() || (0.0..=255.0).contains(value)));
    let mut decoder = Decoder::new(BufReader::new(File::open(file).unwrap())).unwrap();
    let (columns, rows) = decoder.dimensions().unwrap();
    assert_eq!(columns as usize * rows as usize, found.len());
    let scale = decoder.get_tag_f64_vec(Tag::Unknown(33550)).unwrap();
    assert_eq!(scale[..2], [2.0, 2.0]);
    let info: Value = serde_json::from_slice(&run("spinfo", &["--json", "-"], &mesh).stdout).unwrap();
    let place = decoder.get_tag_f64_vec(Tag::Unknown(33922)).unwrap();
    let [left, top] = [place[3], place[4]];
    let bound = |corner: &str, axis: usize| info["bounds"][corner][axis].as_f64().unwrap();
    assert!((0.0..2.0).contains(&(bound("min", 0) - left)) && (0.0..2.0).contains(&(top - bound("max", 1))));
    assert_eq!([left % 2.0, top % 2.0], [0.0, 0.0]);
    assert!(decoder.get_tag_u64_vec(Tag::Unknown(34735)).unwrap().len() >= 8);
}

//! Points of raw numbers.

use spmesh_base::error::{ErrorKind, Result};
use spmesh_formats::source::{Input, RawType, SourceOptions};
use spmesh_stream::model::bounds::Point;

use super::structure::gzip;
use super::{assert_fails, bits, flat, pass, points};
use crate::programs::{Folder, outcome, run};

const THREE: [Point; 3] = [[1.0, 2.0, 3.0], [2.0, -0.5, 3.0], [1.0, -0.0, -1.5]];

fn raw(name: &str) -> SourceOptions {
    SourceOptions { raw: Some(name.parse::<RawType>().unwrap()), ..flat() }
}

/// Points of a file with this content and type.
fn points_of(content: impl AsRef<[u8]>, name: &str) -> Result<Vec<Point>> {
    let folder = Folder::new();
    points(&[folder.file("points.raw", content)], &raw(name))
}

fn bytes<const N: usize>(points: &[Point], bytes_of: impl Fn(f64) -> [u8; N]) -> Vec<u8> {
    points.as_flattened().iter().flat_map(|&x| bytes_of(x)).collect()
}

#[test]
fn triples_are_points_in_either_byte_order() {
    let files = [
        ("f32le", bytes(&THREE, |x| (x as f32).to_le_bytes())),
        ("f32be", bytes(&THREE, |x| (x as f32).to_be_bytes())),
        ("f64le", bytes(&THREE, f64::to_le_bytes)),
        ("f64be", bytes(&THREE, f64::to_be_bytes)),
    ];
    for (name, content) in files {
        assert_eq!(bits(&points_of(content, name).unwrap()), bits(&THREE), "{name}");
    }
    assert_eq!(points_of([255, 0, 7], "i8").unwrap(), [[-1.0, 0.0, 7.0]]);
    assert_eq!(points_of([255, 254, 0, 1, 0, 7], "u16be").unwrap(), [[65534.0, 1.0, 7.0]]);
    // The data may start like a file of another format.
    assert_eq!(points_of(b"LASF\x89SPM#vtk", "u32be").unwrap().len(), 1);
}

#[test]
fn many_points_and_files_are_one_input() {
    let all: Vec<Point> = (0..50_000).map(|i| [f64::from(i), f64::from(i) / 3.0, -f64::from(i)]).collect();
    let folder = Folder::new();
    let paths: Vec<_> = [(0, 20_000), (20_000, 20_001), (20_001, 50_000)]
        .iter()
        .map(|&(start, end)| folder.file(&format!("{start}"), bytes(&all[start..end], f64::to_le_bytes)))
        .collect();
    assert!(points(&paths, &raw("f64le")).unwrap() == all);
}

#[test]
fn a_part_of_a_point_is_an_error() {
    let whole = bytes(&THREE, |x| (x as f32).to_le_bytes());
    for len in 1..whole.len() {
        if len % 12 > 0 {
            let part = format!("{} bytes into a point", len % 12);
            assert_fails(points_of(&whole[..len], "f32le"), ErrorKind::Malformed, &[&part, "f32le"]);
        }
    }
    assert_fails(points_of(&whole[..26], "f32le"), ErrorKind::Malformed, &["point 3 at byte 24"]);
    assert_fails(points_of(b"", "f32le"), ErrorKind::Malformed, &["empty"]);
}

#[test]
fn the_name_of_raw_numbers_tells_whether_they_are_compressed() {
    let whole = bytes(&THREE, |x| (x as f32).to_le_bytes());
    let folder = Folder::new();
    let input = Input::open(&[folder.file("a.raw.GZ", gzip(&whole))], &raw("f32le")).unwrap();
    assert_eq!(pass(&input).unwrap(), points_of(&whole, "f32le").unwrap());
    assert!(input.notices()[0].contains("decompressed 36 bytes"), "{:?}", input.notices());
    let plain = points(&[folder.file("b.raw.gz", &whole)], &raw("f32le"));
    assert_eq!(plain.unwrap(), points_of(&whole, "f32le").unwrap());
}

#[test]
fn numbers_that_are_not_finite_are_refused_or_counted() {
    let content =
        bytes(&[[1.0, 2.0, 3.0], [1.0, f64::NAN, 3.0], [f64::INFINITY, 0.0, 0.0]], f64::to_be_bytes);
    assert_fails(
        points_of(&content, "f64be"),
        ErrorKind::Malformed,
        &["point 2 at byte 24", "--skip-invalid"],
    );
    let folder = Folder::new();
    let path = folder.write("a.raw", &content);
    let output = run("spfinalize", &["--octree", "--raw", "f64be", "--skip-invalid", "--stats", &path], b"");
    let (code, message) = outcome(&output);
    assert!(code == Some(0) && message.contains("invalid points skipped          2"), "{message}");
}

#[test]
fn the_flag_gives_what_the_same_points_give_as_text() {
    let points: Vec<Point> =
        (0..2000u32).map(|i| [i * 7919 % 1009, i * 31 % 97, i % 101].map(f64::from)).collect();
    let text: String = points.iter().map(|[x, y, z]| format!("{x} {y} {z}\n")).collect();
    let boxes = [&["--bounds=100,-1,900,50"][..], &["--octree", "--bounds=100,-1,20,900,50,70"]];
    for dims in [&["--octree"][..], boxes[0], boxes[1]] {
        let raw = [dims, &["-q", "--raw", "f32be"]].concat();
        let from_raw = run("spfinalize", &raw, &bytes(&points, |x| (x as f32).to_be_bytes()));
        let from_text = run("spfinalize", &[dims, &["-q"]].concat(), text.as_bytes());
        assert_eq!(outcome(&from_raw), (Some(0), String::new()));
        assert!(from_raw.stdout == from_text.stdout && from_raw.stdout.len() > 1000);
    }
    let (code, message) = outcome(&run("spfinalize", &["--raw", "f32"], b""));
    assert!(code == Some(2) && message.contains("f32le or f32be"), "{message}");
}

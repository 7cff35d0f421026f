//! PLY as other programs write it: three encodings, properties of any type and order, polygons, points.

use spmesh_base::error::ErrorKind;
use spmesh_formats::drivers::Format;

use super::independent::obj;
use super::{converted, samples, text_of};

/// A square of two triangles and a quadrilateral beside it, with properties that readers ignore.
const TEXT: &str = "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 6\nproperty uchar red\n\
    property float y\nproperty double x\nproperty short z\nelement edge 1\nproperty int from\n\
    property int to\nelement face 3\nproperty list uchar int vertex_indices\n\
    property list uchar float weights\nend_header\n\
    1 0 0 5\n2 0 1 6\n3 1 1 7\n4 1 0 8\n5 0 2 9\n6 1 2 -9\n0 1\n3 0 1 3 0\n3 1 2 3 1 0.5\n4 1 4 5 2 0\n";

fn binary(is_big: bool) -> Vec<u8> {
    let name = if is_big { "binary_big_endian" } else { "binary_little_endian" };
    let (header, rows) = TEXT.split_once("end_header\n").unwrap();
    let mut bytes = format!("{}end_header\n", header.replace("ascii", name)).into_bytes();
    let mut put = |little: &[u8]| {
        if is_big { bytes.extend(little.iter().rev()) } else { bytes.extend(little) }
    };
    let rows: Vec<Vec<f64>> =
        rows.lines().map(|row| row.split(' ').map(|value| value.parse().unwrap()).collect()).collect();
    for row in &rows[..6] {
        put(&[row[0] as u8]);
        put(&(row[1] as f32).to_le_bytes());
        put(&row[2].to_le_bytes());
        put(&(row[3] as i16).to_le_bytes());
    }
    rows[6].iter().for_each(|&end| put(&(end as i32).to_le_bytes()));
    for row in &rows[7..] {
        let corners = row[0] as usize;
        put(&[row[0] as u8]);
        row[1..=corners].iter().for_each(|&corner| put(&(corner as i32).to_le_bytes()));
        put(&[row[corners + 1] as u8]);
        row[corners + 2..].iter().for_each(|&weight| put(&(weight as f32).to_le_bytes()));
    }
    bytes
}

#[test]
fn all_encodings_give_the_same_mesh() {
    for bytes in
        [TEXT.as_bytes().to_vec(), TEXT.replace('\n', "\r\n").into_bytes(), binary(false), binary(true)]
    {
        let soup = obj(&text_of(&converted(&bytes, Format::Ply, Format::Stream).unwrap()));
        assert_eq!(soup.vertices[3], [0.0, 1.0, 8.0]);
        assert_eq!(soup.vertices[5], [2.0, 1.0, -9.0]);
        assert_eq!(soup.triangles, [[0, 1, 3], [1, 2, 3], [1, 4, 5], [1, 5, 2]]);
    }
}

#[test]
fn what_is_written_is_read() {
    for stream in samples::grids().into_iter().map(samples::mesh) {
        let ply = converted(&stream, Format::Stream, Format::Ply).unwrap();
        let back = converted(&ply, Format::Ply, Format::Stream).unwrap();
        assert_eq!(obj(&text_of(&back)), obj(&text_of(&stream)));
    }
    let points = samples::points(2, false, true);
    let ply = converted(&points, Format::Stream, Format::Ply).unwrap();
    let back = text_of(&converted(&ply, Format::Ply, Format::Stream).unwrap());
    assert!(back.contains("#spmesh kind points\n"));
    assert_eq!(obj(&back), obj(&text_of(&points)));
}

#[test]
fn bad_headers_and_rows_are_refused() {
    let face = "3 0 1 3 0\n";
    let cases = [
        (TEXT.replace("vertex 6", "vertex 7"), "a field is missing"),
        (TEXT.replace("vertex 6", "vertex 99999999999999"), "a field is missing"),
        (TEXT.replace("face 3", "face 4"), "truncated"),
        (TEXT.replace("property float y\n", ""), "x, y and z"),
        (TEXT.replace("ascii", "morse"), "format of PLY"),
        (TEXT.replace("property short z", "property complex z"), "type of PLY"),
        (TEXT.replace("end_header\n", ""), "statement of a PLY header"),
        (TEXT.replace(face, "3 0 1 6 0\n"), "vertex 6 of 6"),
        (TEXT.replace(face, "3 0 1 -1 0\n"), "vertex number -1"),
        (TEXT.replace(face, "2 0 1 0\n"), "face of 2 vertices"),
        (TEXT.replace(face, "99999999 0 1 0\n"), "list of 99999999 values"),
        (TEXT.replace("1 0 0 5\n", "1 nan 0 5\n"), "finite number"),
        (TEXT.replace("face 3", "face 2"), "goes on after the rows"),
        (TEXT.replace("vertex_indices", "corners"), "faces with 0 lists"),
        (
            TEXT.replace("end_header", "element void 18446744073709551615\nend_header"),
            "rows of no properties",
        ),
    ];
    for (text, expected) in cases {
        let error = converted(text.as_bytes(), Format::Ply, Format::Stream).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Malformed, "{error}");
        assert!(error.to_string().contains(expected), "{error}");
    }
}

#[test]
fn binary_files_end_with_their_rows() {
    for is_big in [false, true] {
        let bytes = binary(is_big);
        let longer = [&bytes[..], &[0]].concat();
        let start = bytes.len() - 100;
        for damaged in (start..bytes.len()).map(|end| &bytes[..end]).chain([&longer[..]]) {
            let error = converted(damaged, Format::Ply, Format::Stream).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Malformed, "{error}");
            assert!(error.to_string().starts_with("test: element "), "{error}");
        }
    }
}

#[test]
fn what_is_read_over_may_be_no_number() {
    let text = TEXT.replace("1 0 0 5\n", "nan 0 0 5\n").replace("2 3 1 0.5", "2 3 1 inf");
    assert_eq!(
        text_of(&converted(text.as_bytes(), Format::Ply, Format::Stream).unwrap()),
        text_of(&converted(TEXT.as_bytes(), Format::Ply, Format::Stream).unwrap())
    );
}

#[test]
fn triangle_strips_are_triangles() {
    let head = "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n\
        property float z\nelement NAME\nproperty list int int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 0 5\n3 1 5\n";
    let read = |element: &str, rows: &str| {
        converted(format!("{}{rows}", head.replace("NAME", element)).as_bytes(), Format::Ply, Format::Stream)
    };
    let faces = read("face 3", "3 0 1 2\n3 2 1 3\n3 3 4 5\n").unwrap();
    for rows in ["8 0 1 2 3 -1 3 4 5\n", "9 0 1 2 3 -1 3 4 5 -1\n"] {
        assert!(read("tristrips 1", rows).unwrap() == faces, "{rows}");
    }
    assert!(read("tristrips 2", "4 0 1 2 3\n3 3 4 5\n").unwrap() == faces);
    // Vertices that are there twice join two strips.
    assert!(read("tristrips 1", "7 0 1 2 3 3 4 5\n").unwrap() == faces);
    for (rows, part) in [
        ("3 0 1 6\n", "face with vertex 6 of 6"),
        ("3 0 1 -2\n", "vertex number -2"),
        ("2 0 1\n", "strip of 2 vertices"),
    ] {
        let error = read("tristrips 1", rows).unwrap_err();
        assert!(error.kind() == ErrorKind::Malformed && error.to_string().contains(part), "{error}");
    }
}

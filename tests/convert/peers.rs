//! OBJ and PLY keep the mesh; a kind of stream that a format cannot hold is refused.

use std::io::Cursor;

use spmesh_base::error::ErrorKind;
use spmesh_convert::{Options, convert};
use spmesh_formats::drivers::Format;
use spmesh_formats::sink::SinkOptions;
use spmesh_stream::model::bounds::Bounds;
use spmesh_stream::{Coordinates, Header, Kind, write_triangles};

use super::independent::{obj, ply};
use super::{converted, samples, text_of, with_notices};

#[test]
fn obj_and_ply_hold_the_mesh() {
    let streams: Vec<_> = samples::grids().into_iter().map(samples::mesh).collect();
    for stream in
        streams.into_iter().chain([samples::points(2, false, true), samples::points(3, false, false)])
    {
        let expected = obj(&text_of(&stream));
        let text = converted(&stream, Format::Stream, Format::Obj).unwrap();
        assert_eq!(obj(std::str::from_utf8(&text).unwrap()), expected);
        assert_eq!(ply(&converted(&stream, Format::Stream, Format::Ply).unwrap()), expected);
        let options =
            Options { sink: SinkOptions { ascii: true, ..SinkOptions::default() }, ..Options::default() };
        let mut ascii = Vec::new();
        convert(Cursor::new(stream), "test", Format::Ply, &mut ascii, &options, |_| ()).unwrap();
        assert_eq!(ply(&ascii), expected);
    }
}

#[test]
fn plain_obj_is_read() {
    let text = "# cube corner\no thing\nvn 0 0 1\nf 1 2/7 3//1 # late vertices\n";
    assert!(converted(text.as_bytes(), Format::Obj, Format::Stream).is_err(), "a comment in a face");
    let text = "o thing\nvn 0 0 1\nf 1 2/7 3//1\nv 0 0 1 0.5\nv 1 0 2\nv 1 1 3\nv 0 1 4\nf -4 -3 -2 -1\n";
    let (stream, notices) = with_notices(text.as_bytes(), Format::Obj, Format::Stream).unwrap();
    let soup = obj(&text_of(&stream));
    assert_eq!(soup.vertices, [[0.0, 0.0, 1.0], [1.0, 0.0, 2.0], [1.0, 1.0, 3.0], [0.0, 1.0, 4.0]]);
    assert_eq!(soup.triangles, [[0, 1, 2], [0, 1, 2], [0, 2, 3]]);
    assert!(notices[0].contains("all are at the end"));
    for bad in
        ["f 1 2 3\n", "v 0 0 0\nf 1 1 1\n", "v 0 0\n", "f 1 2\n", "hello\n", "f 0 1 2\n", "v 0 0 nan\n"]
    {
        let error = converted(bad.as_bytes(), Format::Obj, Format::Stream).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Malformed, "{bad}");
    }
}

#[test]
fn long_obj_is_cut_into_patches() {
    let mut text = String::new();
    for i in 0..10_000 {
        text += &format!("v {} {} 0\n", i / 2, i % 2);
    }
    for i in 1..=9_998 {
        text += &format!("f {i} {} {}\n", i + 1, i + 2);
    }
    let stream = converted(text.as_bytes(), Format::Obj, Format::Stream).unwrap();
    let twin = text_of(&stream);
    assert_eq!(obj(&twin), obj(&text));
    assert!(twin.matches("# patch").count() > 5);
}

#[test]
fn kinds_that_a_format_cannot_hold_are_refused() {
    let mesh = samples::mesh(samples::grids()[0]);
    let triangles_and_points = [Format::Obj, Format::Ply, Format::Sma, Format::Smb, Format::Spa, Format::Spb];
    let cases = [
        (samples::points(2, true, false), vec![Format::Sma, Format::Smb]),
        (mesh, vec![Format::Spa, Format::Spb]),
        (samples::partial(), triangles_and_points.to_vec()),
        (samples::partial_space(), triangles_and_points.to_vec()),
    ];
    for (stream, formats) in cases {
        for format in formats {
            let error = converted(&stream, Format::Stream, format).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Usage);
            assert!(error.to_string().contains("cannot be written as"), "{error}");
        }
    }
}

#[test]
fn formats_are_recognized_by_content() {
    let mesh = samples::mesh(samples::grids()[0]);
    let points = samples::points(2, true, false);
    for (stream, formats) in [
        (&mesh, [Format::Stream, Format::Twin, Format::Obj, Format::Sma, Format::Smb].as_slice()),
        (&points, [Format::Stream, Format::Twin, Format::Spa, Format::Spb].as_slice()),
    ] {
        for &format in formats {
            let input = converted(stream, Format::Stream, format).unwrap();
            let mut output = Vec::new();
            convert(Cursor::new(input), "-", Format::Twin, &mut output, &Options::default(), |_| ()).unwrap();
        }
    }
    let plain = b"v 0 0 0\nv 1 0 0\n".to_vec();
    let guess = |name: &str| {
        convert(
            Cursor::new(plain.clone()),
            name,
            Format::Stream,
            &mut Vec::new(),
            &Options::default(),
            |_| (),
        )
    };
    assert_eq!(guess("stdin").unwrap_err().kind(), ErrorKind::Usage);
    guess("mesh.OBJ").unwrap();
    guess("points.spa").unwrap();
}

#[test]
fn local_coordinates_are_exact_in_32_bits() {
    // Coordinates with steps of a hundredth, far from the origin, which f32 rounds to multiples of 0.25 and 0.5.
    let point = |i: u32| [i % 17 * 613, i / 17 * 977, i * 71 % 500].map(|part| f64::from(part) - 4000.0);
    let points: Vec<[f64; 3]> = (0..60).map(point).collect();
    let triangles: Vec<[u32; 3]> = (0..58).map(|i| [i, i + 1, i + 2]).collect();
    let coordinates = Coordinates::I32 { scale: [0.01; 3], offset: [2_499_000.0, 7_100_000.0, 20.0] };
    let mut header = Header::new(Kind::TriangleMesh, coordinates, 2, true);
    header.bounds = Bounds::of_points(&points);
    let mut stream = Vec::new();
    let at = |vertex: u32| points[vertex as usize];
    write_triangles(header, &triangles, points.len(), 0, at, &mut stream).unwrap();
    let expected =
        obj(std::str::from_utf8(&converted(&stream, Format::Stream, Format::Obj).unwrap()).unwrap());
    let options =
        Options { sink: SinkOptions { local_origin: true, ..SinkOptions::default() }, ..Options::default() };
    let mut text = Vec::new();
    convert(Cursor::new(stream.clone()), "test", Format::Obj, &mut text, &options, |_| ()).unwrap();
    let text = String::from_utf8(text).unwrap();
    let origin = text.lines().find_map(|line| line.strip_prefix("# origin ")).expect("a comment");
    let origin: Vec<f64> = origin.split(' ').map(|number| number.parse().unwrap()).collect();
    let local = obj(&text);
    assert_eq!(local.triangles, expected.triangles);
    for (local, world) in local.vertices.iter().zip(&expected.vertices) {
        for axis in 0..3 {
            assert!((origin[axis] + local[axis] - world[axis]).abs() < 1e-8);
            assert!((f64::from(local[axis] as f32) - local[axis]).abs() < 1e-5);
            // As many digits as the world has.
            assert_eq!((local[axis] * 100.0).round() / 100.0, local[axis]);
        }
    }
    let error =
        convert(Cursor::new(stream), "test", Format::Ply, &mut Vec::new(), &options, |_| ()).unwrap_err();
    assert!(
        error.kind() == ErrorKind::Usage && error.to_string().contains("--local-origin is for OBJ"),
        "{error}"
    );
}

//! Lines of x y z t.

use spmesh_base::error::ErrorKind;
use spmesh_formats::volumes::{From4, read_points4};

use super::{all, assert_fails, gzip, read, with_condition};
use crate::programs::Folder;

#[test]
fn lines_may_be_separated_as_usual() {
    let expected = [[1.0, 2.0, 3.0, 4.0], [-1.5, 1e3, 0.0, 7.0]];
    for text in [
        "1 2 3 4\n-1.5 1e3 -0 7\n",
        "1\t2\t3\t4\r\n-1.5\t1e3\t0\t7",
        "1,2,3,4\n-1.5, 1e3 , 0,7\n",
        "# a comment\n\n  1 2 3 4 # another\n// and one more\n-1.5 1e3 0 7\n",
        "x y z t\n1 2 3 4\n-1.5 1e3 0 7\n",
        "\"left\",\"up\",\"far\",\"late\"\n1,2,3,4\n-1.5,1e3,0,7\n",
        "time,z,y,x\n4,3,2,1\n7,0,1e3,-1.5\n",
        "id,x,y,z,t,note\na,1,2,3,4,b\nc,-1.5,1e3,0,7,d\n",
    ] {
        let points = read(text).unwrap_or_else(|e| panic!("{text:?}: {e}"));
        assert_eq!(points.points, expected, "{text:?}");
        assert!(points.points[1][2].is_sign_positive());
        assert_eq!((points.values, points.sites, points.warnings), (None, 2, vec![]));
    }
}

#[test]
fn a_fifth_column_is_the_value() {
    for text in [
        "1 2 3 4 0.5\n5 6 7 8 inf\n",
        "t,value,x,y,z\n4,.5,1,2,3\n8,inf,5,6,7\n",
        "x y z t w\n1 2 3 4 .5\n5 6 7 8 inf",
    ] {
        let points = read(text).unwrap();
        assert_eq!(points.points, [[1.0, 2.0, 3.0, 4.0], [5.0, 6.0, 7.0, 8.0]]);
        assert_eq!(points.values, Some(vec![0.5, f64::INFINITY]));
    }
}

#[test]
fn a_missing_value_is_left_out_unless_it_is_wanted() {
    let folder = Folder::new();
    let from = From4::File(folder.file("points.txt", "1 2 3 4 nan\n5 6 7 8 1\n"));
    let points = read_points4(&all(from.clone())).unwrap();
    assert_eq!((points.points, points.sites), (vec![[5.0, 6.0, 7.0, 8.0]], 2));
    assert_eq!(points.warnings, ["1 of 2 points have no value (NaN) and are left out"]);

    let mut request = all(from.clone());
    request.selection.keep_nan = true;
    let points = read_points4(&request).unwrap();
    assert_eq!(points.points.len(), 2);
    assert!(points.values.unwrap()[0].is_nan() && points.warnings.is_empty());

    let mut request = with_condition(from, "value != 3");
    request.selection.keep_nan = true;
    assert_eq!(read_points4(&request).unwrap().points.len(), 1);
}

#[test]
fn compressed_text_is_read() {
    let text = b"1 2 3 4\n5 6 7 8\n".repeat(10_000);
    assert_eq!(read(gzip(&text)).unwrap().points.len(), 20_000);
    let cut = &gzip(&text)[..60];
    assert_fails(read(cut), ErrorKind::Malformed, &["gzip data ends early"]);
}

#[test]
fn errors_name_line_and_column() {
    let cases: [(&str, &[&str]); 13] = [
        ("1 2 3 4\n1 2 three 4\n", &["line 2", "\"three\" in column 3", "a finite number"]),
        ("1 2 3 4\n1 2 3 nan\n", &["line 2", "column 4", "finite"]),
        ("1 2 3 inf\n", &["line 1", "column 4", "finite"]),
        ("1 2 3 4 5\n1 2 3 4 x\n", &["line 2", "\"x\" in column 5", "a number"]),
        ("1 2 3 4\n\n# comment\n1 2 3\n", &["line 4", "found 3 columns, but 4 in the first"]),
        ("1 2 3 4\n1 2 3 4 5\n", &["line 2", "found 5 columns, but 4"]),
        ("1,2,,4\n", &["line 1", "\"\" in column 3"]),
        ("1 2 3\n", &["line 1", "found 3 columns, expected x y z t"]),
        ("1 2 3 4 5 6\n", &["line 1", "found 6 columns"]),
        ("x y z\n1 2 3 4\n", &["line 2", "found 4 columns, but line 1 has names for 3"]),
        ("a b c d e f\n1 2 3 4 5 6\n", &["line 2", "found 6 columns"]),
        ("x y z t\n", &["line 1", "expected a line of x y z t"]),
        ("", &["found no point"]),
    ];
    for (text, parts) in cases {
        assert_fails(read(text), ErrorKind::Malformed, parts);
    }
}

#[test]
fn a_second_line_of_words_is_no_header() {
    assert_fails(read("x y z t\nm m m s\n1 2 3 4\n"), ErrorKind::Malformed, &["line 2", "column 1"]);
}

#[test]
fn other_formats_are_told_apart() {
    let cases: [(&[u8], &str); 8] = [
        (b"CDF\x01\0\0\0\0", "netCDF"),
        (b"\x89HDF\r\n\x1a\n", "HDF5"),
        (b"# vtk DataFile Version 3.0\n", "VTK"),
        (b"<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\">", "VTK"),
        (b"\x1f\x8b", "gzip data ends early"),
        (b"1 2 3 4\n\0\0\0", "--raw"),
        (b"BZh91AY", "bzip2"),
        (b"\x89SPM\r\n\x1a\n", "truncated: found 8 of the first 16 bytes"),
    ];
    for (content, part) in cases {
        assert_fails(read(content), ErrorKind::Malformed, &[part]);
    }
    assert_fails(
        read(gzip(&gzip(b"1 2 3 4\n"))),
        ErrorKind::Malformed,
        &["gzip data within compressed data"],
    );
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let result = read_points4(&all(From4::File("/nowhere/points.txt".into())));
    assert_fails(result, ErrorKind::Io, &["/nowhere/points.txt", "opening"]);
}

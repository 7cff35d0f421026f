//! Text: xyz, csv and similar formats.

use spmesh_base::error::ErrorKind;
use spmesh_formats::source::{Input, SourceOptions};

use super::{assert_fails, flat, pass, points_of};
use crate::programs::Folder;

#[test]
fn every_separator_comment_and_line_end_is_understood() {
    let expected = [[1.5, -2.0, 3e-3], [4.0, 5.0, 6.0]];
    let texts = [
        "1.5 -2 3e-3\n4 5 6\n",
        "  1.5\t-2   .003 \n\n4 5 6",
        "1.5,-2,0.003\n4, 5 ,6\n",
        "1.5;-2;0.003;extra\n4;5;6;\n",
        "# x y z\n1.5 -2 0.003 # first\n// none\n4 5 6\n",
        "1.5 -2 0.003\r\n4 5 6\r\n",
        "\u{feff}1.5 -2 0.003\n4 5 6\n",
        "x,y,z\n1.5,-2,0.003\n4,5,6\n",
        "id,Z,\"X\",y\n7,0.003,\"1.5\",-2\n8,6,4,5\n",
        "point id\ty\tx\tz\na b\t-2\t1.5\t0.003\nc\t5\t4\t6\n",
        "east north up\n1.5 -2 0.003\n4 5 6\n",
        "id,Easting,Northing,Elevation\n7,1.5,-2,0.003\n8,4,5,6\n",
    ];
    for text in texts {
        assert_eq!(points_of(text).unwrap(), expected, "{text:?}");
    }
}

#[test]
fn two_columns_have_no_elevation() {
    let folder = Folder::new();
    for (text, has_elevation) in
        [("1 2\n", false), ("x,y,name\n1,2,a\n", false), ("1 2 3\n", true), ("# none\n", false)]
    {
        let path = folder.file("a.txt", text);
        let input = Input::open(std::slice::from_ref(&path), &flat()).unwrap();
        assert_eq!(input.description().has_elevation, has_elevation, "{text:?}");
        if has_elevation || text.starts_with('#') {
            continue;
        }
        assert_eq!(pass(&input).unwrap(), [[1.0, 2.0, 0.0]]);
        let solid = SourceOptions { dims: 3, ..flat() };
        assert_fails(Input::open(&[path], &solid), ErrorKind::Usage, &["third coordinate"]);
    }
    let (with, without) = (folder.file("with", "1 2 3\n"), folder.file("without", "1 2\n"));
    assert_fails(Input::open(&[with, without], &flat()), ErrorKind::Usage, &["with ", "without "]);
}

#[test]
fn numbers_are_read_exactly() {
    let text = "0.1 123456789.123456789 1e-320\n9007199254740993 -0 1.7976931348623157e308\n";
    let expected = [[0.1, 123456789.12345679, 1e-320], [9007199254740992.0, -0.0, f64::MAX]];
    let found = points_of(text).unwrap();
    assert_eq!(
        found.as_flattened().iter().map(|v| v.to_bits()).collect::<Vec<_>>(),
        expected.as_flattened().iter().map(|v: &f64| v.to_bits()).collect::<Vec<_>>()
    );
}

#[test]
fn bad_lines_are_named_and_shown() {
    let cases: [(&str, &[&str]); 16] = [
        ("1 2 3\n1 2\n", &["line 2", "2 columns", "at least 3"]),
        ("1 2 3\n\n# \n1 2 three\n", &["line 4", "\"three\"", "column 3"]),
        ("1,5;2,5;3\n", &["line 1", "\"1,5\""]),
        ("1\n", &["line 1", "1 column ", "at least 2"]),
        ("names\nmore names\n1 2\n", &["line 1", "names of the columns"]),
        ("a name\nmore names\n1 2\n", &["line 1", "names of the columns"]),
        ("x y\nmore names\n1 2\n", &["line 2", "\"more\""]),
        ("at[0] = (1,2,3);\nat[1] = (4,5,6);\n", &["line 1", "expected a point", "separated"]),
        ("LAS", &["line 1", "expected a point"]),
        ("OFF\n3 1 0\n0 0 0\n", &["this is an OFF file", "tess3 reads"]),
        ("REMARK   3\n", &["PDB", "tess3"]),
        ("data_1ABC\n#\n", &["mmCIF", "tess3"]),
        ("id,e,n,up\n7,1,2,3\n", &["line 1", "call them x, y and z"]),
        ("1 2\n1 2 3\n", &["line 2", "3 columns", "two in the first"]),
        ("1 2 3\r4 5 6\r", &["line 1", "carriage return"]),
        ("1 2 3\n1 nan 3\n", &["line 2", "not finite"]),
    ];
    for (text, parts) in cases {
        assert_fails(points_of(text), ErrorKind::Malformed, &[&["points"], parts].concat());
    }
    let long = format!("1 2 3\n{}\n", "1".repeat(1 << 17));
    assert_fails(points_of(long), ErrorKind::Malformed, &["line 2", "more than 65536 bytes"]);
}

#[test]
fn invalid_points_are_dropped_and_counted_on_demand() {
    let folder = Folder::new();
    let path = folder.file("a.xyz", "1 2 3\nnan 2 3\n1 inf 3\n1e999 0 0\n4 5 6\n");
    let input = Input::open(&[path], &SourceOptions { skip_invalid: true, ..flat() }).unwrap();
    let mut reader = input.read().unwrap();
    let mut batch = Vec::new();
    reader.next_batch(&mut batch).unwrap();
    assert_eq!(batch, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    reader.next_batch(&mut batch).unwrap();
    assert!(batch.is_empty());
    assert_eq!(reader.invalid(), 3);
}

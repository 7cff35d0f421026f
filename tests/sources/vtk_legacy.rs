//! Points of the legacy format of VTK.

use spmesh_base::error::{ErrorKind, Result};
use spmesh_stream::model::bounds::Point;

use super::{assert_fails, damage, points_of};

const THREE: [Point; 3] = [[1.0, 2.0, 3.0], [2.0, -0.5, 3.0], [1.0, 1.0, -1.5]];

/// A file with `middle` between its title and its points.
fn text(middle: &str) -> String {
    format!(
        "# vtk DataFile Version 3.0\nATOM v 1 2 3\nASCII\n{middle}POINTS 3 float\n1 2 3 2 -0.5\n\n3\n1 1 -1.5\nCELLS 0 0\n"
    )
}

/// A binary file with these values of `kind` as points, and `middle` before them.
fn binary(kind: &str, middle: &[u8], values: &[u8]) -> Vec<u8> {
    let start = b"# vtk DataFile Version 5.1\nx\nBINARY\nDATASET UNSTRUCTURED_GRID\n";
    let len = if matches!(kind, "double" | "long") { 24 } else { 12 };
    let statement = format!("POINTS {} {kind}\n", values.len() / len);
    [start, middle, statement.as_bytes(), values, b"\nMETADATA\nINFORMATION 0\n\nCELLS 0 0\n"].concat()
}

fn doubles() -> Vec<u8> {
    THREE.as_flattened().iter().flat_map(|x| x.to_be_bytes()).collect()
}

#[test]
fn points_of_text_are_read() {
    for dataset in ["UNSTRUCTURED_GRID", "POLYDATA", "polydata", "STRUCTURED_GRID\nDIMENSIONS 3 1 1"] {
        for end in ["\n", "\r\n"] {
            let file = text(&format!("\nDATASET {dataset}\n")).replace('\n', end);
            assert_eq!(points_of(file).unwrap(), THREE, "{dataset}");
        }
    }
    let field = "FIELD FieldData 3\nTIME 1 1 double\n2.5\nMETADATA\nINFORMATION 1\nNAME A LOCATION b\nDATA 1 0\n\n\
                 who 1 2 string\nPOINTS%20\n\nbits 3 3 bit\n0 1 0\n1 1 0 1 0 1\n";
    let metadata = "METADATA\nINFORMATION 0\n\n";
    let between = format!("{field}DATASET POLYDATA\n{field}{metadata}");
    assert_eq!(points_of(text(&between)).unwrap(), THREE);
}

#[test]
fn points_of_bytes_are_big_endian() {
    assert_eq!(points_of(binary("double", b"", &doubles())).unwrap(), THREE);
    let floats: Vec<u8> = THREE.as_flattened().iter().flat_map(|&x| (x as f32).to_be_bytes()).collect();
    assert_eq!(points_of(binary("float", b"", &floats)).unwrap(), THREE);
    let integers: Vec<u8> = [1i32, -2, 3].iter().flat_map(|x| x.to_be_bytes()).collect();
    assert_eq!(points_of(binary("int", b"", &integers)).unwrap(), [[1.0, -2.0, 3.0]]);
    // Strings come after their length, in one byte or more. Both strings and bits may contain keywords and
    // line feeds.
    let mut field = b"FIELD FieldData 3\nt 1 1 double\n\nPOINTS\n\nwho 1 3 string\n\xc7POINTS\n".to_vec();
    field.extend([&[0x80, 70][..], &[b'\n'; 70], &[0x40, 0, 0, 2], b"\n\n"].concat());
    field.extend(b"\nbits 1 9 bit\n\n\n\n");
    assert_eq!(points_of(binary("double", &field, &doubles())).unwrap(), THREE);
}

#[test]
fn what_is_wrong_is_said_and_where() {
    let grid = "DATASET UNSTRUCTURED_GRID\n";
    let whole = text(grid);
    let fails = |file: String, parts: &[&str]| assert_fails(points_of(file), ErrorKind::Malformed, parts);
    fails(whole.replace("ASCII", "HEX"), &["line 3", "\"hex\"", "ASCII or BINARY"]);
    fails(whole.replace("POINTS 3", "POINTS x"), &["line 5", "\"x\"", "integer"]);
    fails(whole.replace("POINTS 3", "POINTS 18446744073709551615"), &["line 5", "no file holds as many"]);
    fails(whole.replace("3 float", "3 quad"), &["line 5", "\"quad\""]);
    fails(whole.replace("-1.5", "-1.5a"), &["point 3", "\"-1.5a\""]);
    fails(whole.replace("POINTS 3", "POINTS 4"), &["point 4", "\"CELLS\""]);
    fails(whole[..whole.find("-1.5").unwrap()].to_string(), &["point 3", "found 8 of 9"]);
    fails(whole[..whole.find("POINTS").unwrap()].to_string(), &["truncated"]);
    fails(whole.replace("POINTS", "VERTICES"), &["line 5", "\"vertices\"", "POINTS"]);
    fails(text("DATASET TABLE\n"), &["line 4", "\"table\""]);
    fails(text("FIELD f 99999999999\n"), &["integer"]);
    fails(text("FIELD f 1\na 18446744073709551615 2 int\n"), &["times"]);
    let lattice = points_of(text("DATASET STRUCTURED_POINTS\n"));
    assert_fails(lattice, ErrorKind::Usage, &["line 4", "lattice"]);
    let cut = binary("double", b"", &doubles());
    let cut = &cut[..cut.len() - 50];
    assert_fails(points_of(cut), ErrorKind::Malformed, &["line 5", "3 points have 72 bytes"]);
    assert_fails(points_of(binary("long", b"", &doubles())), ErrorKind::Usage, &["line 5", "4 or 8 bytes"]);
    let field = b"FIELD f 1\na 1 18446744073709551615 double\n";
    assert_fails(points_of(binary("double", field, &doubles())), ErrorKind::Malformed, &["truncated"]);
    let nan: Vec<u8> = [1.0, f64::NAN, 0.0].iter().flat_map(|x: &f64| x.to_be_bytes()).collect();
    assert_fails(points_of(binary("double", b"", &nan)), ErrorKind::Malformed, &["point 1 at byte 78"]);
}

#[test]
fn damage_is_survived_and_no_cut_passes_for_a_whole_file() {
    let field =
        b"FIELD FieldData 2\nwho 1 2 string\n\xc3abc\xc1x\nbits 1 9 bit\nab\nMETADATA\nINFORMATION 0\n\n";
    let ascii = text("DATASET POLYDATA\nFIELD f 1\na 1 2 string\nx\ny\n");
    for whole in [binary("double", field, &doubles()), ascii.into_bytes()] {
        damage::damage_bytes(&whole, 0..whole.len());
        let expected = points_of(&whole).unwrap();
        // A file shorter than its first words is not detected as VTK.
        for len in 14..whole.len() {
            let found: Result<Vec<Point>> = points_of(&whole[..len]);
            // Cutting a number in text may give another number; all other cuts are noticed.
            if let Ok(found) = found {
                let is_last = whole[..len].ends_with(b"-1") || whole[..len].ends_with(b"-1.");
                assert!(found == expected || (is_last && found[..2] == expected[..2]), "cut at {len}");
            }
        }
    }
}

//! Arrays of numpy, in and out, and derivatives. Arrays are made and parsed here, byte by byte.

use std::fs;

use super::{bowl, knots, output, points, rows};
use crate::programs::{Folder, assert_outcome, outcome, run};

/// An array: its shape, and its numbers.
pub(super) struct Array {
    pub(super) dtype: String,
    pub(super) shape: Vec<usize>,
    pub(super) bytes: Vec<u8>,
}

impl Array {
    /// Parses a file in C order.
    pub(super) fn parse(file: &[u8]) -> Array {
        assert_eq!(&file[..8], b"\x93NUMPY\x01\x00");
        let end = 10 + usize::from(file[8]) + 256 * usize::from(file[9]);
        assert_eq!((end % 64, file[end - 1]), (0, b'\n'));
        let text = std::str::from_utf8(&file[10..end]).unwrap();
        assert!(text.contains("'fortran_order': False"), "{text}");
        let between = |from: &str, to: &str| text.split(from).nth(1).unwrap().split(to).next().unwrap();
        let shape = between("'shape': (", ")").split(',').map(str::trim).filter(|word| !word.is_empty());
        let shape: Vec<usize> = shape.map(|word| word.parse().unwrap()).collect();
        let dtype = between("'descr': '", "'").to_string();
        let bytes = file[end..].to_vec();
        let number_len: usize = dtype[2..].parse().unwrap();
        assert_eq!(bytes.len(), number_len * shape.iter().product::<usize>(), "{text}");
        Array { dtype, shape, bytes }
    }

    pub(super) fn numbers(&self) -> Vec<f64> {
        assert_eq!(self.dtype, "<f8");
        self.bytes.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect()
    }
}

/// A file with a header as numpy writes it, of a version of the format.
fn npy(version: u8, dtype: &str, order: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let text = format!("{{'descr': {dtype}, 'fortran_order': {order}, 'shape': {shape}, }}\n");
    let mut file = [b"\x93NUMPY".as_slice(), &[version, 0]].concat();
    match version {
        1 => file.extend((text.len() as u16).to_le_bytes()),
        _ => file.extend((text.len() as u32).to_le_bytes()),
    }
    file.extend(text.bytes());
    file.extend(data);
    file
}

fn spline() -> Vec<u8> {
    let folder = Folder::new();
    let (knots, points) =
        (folder.write("knots.txt", knots()), folder.write("points.txt", points(3_000, 2, bowl)));
    output(&["fit", "--knots", &knots, &points], &[])
}

/// Sites with coordinates that all types can hold; the last one is outside of the domain.
const SITES: [[i16; 2]; 4] = [[3, 7], [40, 60], [99, 1], [120, 9]];

/// Encodes a coordinate.
type Encode<'a> = &'a dyn Fn(i16) -> Vec<u8>;

fn table(sites: &[[i16; 2]]) -> String {
    sites.iter().map(|[x, y]| format!("{x} {y}\n")).collect()
}

#[test]
fn sites_of_all_types_and_orders_are_those_of_text() {
    let (folder, spline) = (Folder::new(), spline());
    let text = folder.write("sites.txt", table(&SITES));
    let expected = output(&["eval", "-", "--at", &text], &spline);
    let columns = [0, 1].map(|axis| SITES.map(|site| site[axis]));
    let of = |encode: Encode, is_by_columns: bool| -> Vec<u8> {
        let numbers = if is_by_columns { columns.concat() } else { SITES.concat() };
        numbers.into_iter().flat_map(encode).collect()
    };
    let types: [(&str, Encode); 8] = [
        ("'<f8'", &|x| f64::from(x).to_le_bytes().to_vec()),
        ("'>f8'", &|x| f64::from(x).to_be_bytes().to_vec()),
        ("'<f4'", &|x| f32::from(x).to_le_bytes().to_vec()),
        ("'>f4'", &|x| f32::from(x).to_be_bytes().to_vec()),
        ("'<i4'", &|x| i32::from(x).to_le_bytes().to_vec()),
        ("'>i4'", &|x| i32::from(x).to_be_bytes().to_vec()),
        ("'<i8'", &|x| i64::from(x).to_le_bytes().to_vec()),
        ("'|u1'", &|x| vec![x as u8]),
    ];
    for (number, (dtype, encode)) in types.into_iter().enumerate() {
        for (order, is_by_columns) in [("False", false), ("True", true)] {
            let version = 1 + (number % 3) as u8;
            let bytes = npy(version, dtype, order, "(4, 2)", &of(encode, is_by_columns));
            let path = folder.write("sites.npy", bytes);
            let found = output(&["eval", "-", "--at", &path], &spline);
            assert_eq!(found, expected, "{dtype} {order}");
        }
    }
}

#[test]
fn points_can_be_an_array() {
    let folder = Folder::new();
    let text = points(2_000, 3, bowl);
    let data: Vec<u8> =
        text.split_whitespace().flat_map(|word| word.parse::<f64>().unwrap().to_be_bytes()).collect();
    let array = folder.write("points.npy", npy(2, "'>f8'", "False", "(2000, 3)", &data));
    let fitted = |path: &str| output(&["fit", "--step", "20", "--lambda", "1", path], &[]);
    let spline = fitted(&array);
    assert!(spline == fitted(&folder.write("points.txt", text)));
    // Other programs read it, too.
    let streams =
        ["points.npy", "points.txt"].map(|name| run("spfinalize", &[&folder.path(name)], &[]).stdout);
    assert!(!streams[0].is_empty() && streams[0] == streams[1]);
}

#[test]
fn values_are_written_as_arrays() {
    let (folder, spline) = (Folder::new(), spline());
    let spline = folder.write("spline.spm", spline);
    let sites = folder.write("sites.txt", table(&SITES));
    for (kind, shape) in [("value", &[4][..]), ("gradient", &[4, 2]), ("hessian", &[4, 3]), ("slope", &[4])] {
        let arguments = ["eval", &spline, "--at", &sites, "--kind", kind];
        let text = rows(&output(&arguments, &[]));
        let path = folder.path("values.npy");
        output(&[&arguments[..], &["-o", &path]].concat(), &[]);
        let array = Array::parse(&fs::read(&path).unwrap());
        assert_eq!(array.shape, shape);
        let expected: Vec<f64> = text.iter().flat_map(|row| row[2..].iter().copied()).collect();
        let found = array.numbers();
        assert!(found.last().unwrap().is_nan());
        assert!(found.iter().zip(&expected).all(|(a, b)| a == b || a.is_nan() && b.is_nan()), "{found:?}");
        // A pipe gets the same bytes.
        let piped = output(&[&arguments[..], &["--format", "npy"]].concat(), &[]);
        assert!(piped == fs::read(&path).unwrap());
    }
}

#[test]
fn rasters_are_written_as_arrays_with_the_top_row_first() {
    let (folder, spline) = (Folder::new(), spline());
    let spline = folder.write("spline.spm", spline);
    for (kind, numbers) in [("value", 1), ("gradient", 2), ("hessian", 3)] {
        let arguments = ["eval", &spline, "--bounds", "-3,10,30,80", "--step", "1", "--kind", kind];
        let path = folder.path("raster.npy");
        let made = run("splinefit", &[&arguments[..], &["-o", &path]].concat(), &[]);
        let (code, message) = outcome(&made);
        assert_eq!(code, Some(0), "{message}");
        assert!(message.contains("array[i, j] is at x = -2.5 + 1 * j, y = 79.5 - 1 * i"), "{message}");
        assert!(message.contains("33 by 70 cells of size 1, 210 of 2310 without data"), "{message}");
        let array = Array::parse(&fs::read(&path).unwrap());
        assert_eq!(array.shape, if numbers == 1 { vec![70, 33] } else { vec![70, 33, numbers] });
        let found = array.numbers();
        let text = rows(&output(&arguments, &[]));
        assert_eq!(text.len(), 70 * 30);
        for row in text {
            let (i, j) = ((79.5 - row[1]) as usize, (row[0] + 2.5) as usize);
            for (number, expected) in row[2..].iter().enumerate() {
                let value = found[(i * 33 + j) * numbers + number];
                assert!((value - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{row:?}: {value}");
            }
        }
        assert_eq!(found.iter().filter(|value| value.is_nan()).count(), 210 * numbers);
    }
}

#[test]
fn bad_arrays_are_refused_with_their_place() {
    let (folder, spline) = (Folder::new(), spline());
    let floats = |numbers: &[f64]| -> Vec<u8> { numbers.iter().flat_map(|x| x.to_le_bytes()).collect() };
    let good = floats(&[1.0, 2.0, 3.0, 4.0]);
    let f8 = |shape: &str, data: &[u8]| npy(1, "'<f8'", "False", shape, data);
    let of_type = |dtype: &str| npy(1, dtype, "False", "(2, 2)", &good);
    let cases: [(Vec<u8>, &[&str]); 18] = [
        (f8("(2, 2)", &good)[..20].to_vec(), &["truncated: the header ends at byte", "byte 20"]),
        (b"\x93NUMPY\x01\x00".to_vec(), &["truncated: the header ends at byte 10", "byte 8"]),
        (f8("(2, 2)", &good[..31]), &["truncated: found 31 of 32 bytes of the array"]),
        (f8("(2, 2)", &floats(&[0.0; 5])), &["8 bytes follow the array"]),
        (f8("(0, 2)", &[]), &["shape (0, 2): no rows"]),
        (f8("(4,)", &good), &["shape (4,)", "(n, 2)"]),
        (f8("()", &good[..8]), &["shape ()", "(n, 2)"]),
        (f8("(1, 2, 2)", &good), &["shape (1, 2, 2)"]),
        (f8("(1, 4)", &good), &["shape (1, 4)", "array[:, :3]"]),
        (f8("(2, 9)", &floats(&[0.0; 18])), &["shape (2, 9)", "its transpose has shape (9, 2)"]),
        (f8("(18446744073709551615, 3)", &good), &["truncated: found 32 of"]),
        (
            f8("(2, 2)", &floats(&[0.0, 1.0, 2.0, f64::NAN])),
            &["row 1 (counted from 0)", "not finite", "leave it out"],
        ),
        (f8("(2, 2)", &floats(&[0.0, f64::INFINITY, 2.0, 1.0])), &["row 0 (counted from 0)", "not finite"]),
        (of_type("'|O'"), &["dtype |O", "expected floating-point numbers or integers"]),
        (of_type("'<c16'"), &["dtype <c16", "expected floating-point"]),
        (of_type("[('x', '<f8'), ('y', '<f8')]"), &["structured dtype", "numpy.column_stack"]),
        (npy(9, "'<f8'", "False", "(2, 2)", &good), &["version 9.0 of the format"]),
        (npy(1, "'<f8'", &"(".repeat(20_000), "(2, 2)", &good), &["headers of arrays have at most"]),
    ];
    for (bytes, parts) in cases {
        let path = folder.write("sites.npy", bytes);
        for part in parts {
            assert_outcome("splinefit", &["eval", "-", "--at", &path], &spline, 3, part);
        }
    }
    // An array of points without elevations, and an archive of arrays.
    let path = folder.write("sites.npy", f8("(2, 2)", &good));
    assert_outcome("splinefit", &["fit", &path], &[], 2, "points have no elevation");
    let path = folder.write("sites.npz", b"PK\x03\x04");
    assert_outcome("splinefit", &["eval", "-", "--at", &path], &spline, 3, "zip");
}

#[test]
fn names_of_arrays_never_get_text() {
    let (folder, spline) = (Folder::new(), spline());
    let spline = folder.write("spline.spm", spline);
    let (sites, points) =
        (folder.write("sites.txt", table(&SITES)), folder.write("points.txt", points(500, 1, bowl)));
    let [npy, npz, mtx] = ["out.npy", "out.npz", "out.mtx"].map(|name| folder.path(name));
    let cases: [(&[&str], &str); 12] = [
        (&["eval", &spline, "--at", &sites, "-o", &npz], "values go to .npy"),
        (&["eval", &spline, "--step", "9", "-o", &mtx], "values go to .npy"),
        (&["eval", &spline, "--at", &sites, "--format", "npz"], "values go to .npy"),
        (&["eval", &spline, "--at", &sites, "--format", "tif"], "sites are no raster"),
        (&["eval", &spline, "--at", &sites, "-o", "x.csv"], "this program writes .npy, .txt, .xyz or .dat"),
        (&["eval", &spline, "--at", &sites, "--collocation", "-o", &npy], ".mtx or .npz"),
        (&["eval", &spline, "--at", &sites, "--collocation", "--format", "text"], "take --format mtx or npz"),
        (&["eval", &spline, "--collocation"], "--at"),
        (&["fit", &points, "-o", &npy], "an array of numpy"),
        (&["fit", &points, "-o", "/dev/null", "--residuals", &npy], "an array of numpy"),
        (&["fit", &points, "-o", "/dev/null", "--robust", "tukey", "--rejected", &npz], "several arrays"),
        (&["mesh", &spline, "-o", &npy], "an array of numpy"),
    ];
    for (arguments, part) in cases {
        assert_outcome("splinefit", arguments, &[], 2, part);
    }
    assert!(!folder.names("").iter().any(|name| name.starts_with("out")));
}

#[test]
fn hessians_are_those_of_reproduced_polynomials_and_of_differences() {
    let folder = Folder::new();
    let sites = folder.write("sites.txt", points(200, 41, |_, _| 0.0));
    // A polynomial of degree 2 is reproduced, with its second derivatives.
    let of = |spline: &[u8], sites: &str, kind: &str| {
        rows(&output(&["eval", "-", "--at", sites, "--kind", kind], spline))
    };
    for row in of(&spline(), &sites, "hessian") {
        for (found, expected) in row[2..].iter().zip([0.02, -0.02, 0.06]) {
            assert!((found - expected).abs() < 1e-9, "{row:?}");
        }
    }
    // Central differences of gradients, of a wave.
    let wave = points(4_000, 3, |x, y| (0.1 * x).sin() * (0.08 * y).cos() + 0.02 * x);
    let (knots, wave) = (folder.write("knots.txt", knots()), folder.write("wave.txt", wave));
    let wavy = output(&["fit", "--knots", &knots, &wave], &[]);
    const H: f64 = 1e-5;
    let moved = |dx: f64, dy: f64| {
        let inner = rows(fs::read(&sites).unwrap().as_slice());
        let text: String = inner
            .iter()
            .map(|row| format!("{} {}\n", 10.0 + 0.8 * row[0] + dx, 8.0 + 0.8 * row[1] + dy))
            .collect();
        folder.write("moved.txt", text)
    };
    let gradients =
        [[H, 0.0], [-H, 0.0], [0.0, H], [0.0, -H]].map(|[dx, dy]| of(&wavy, &moved(dx, dy), "gradient"));
    let found = of(&wavy, &moved(0.0, 0.0), "hessian");
    let greatest =
        found.iter().flat_map(|row| row[2..].iter()).fold(0f64, |most, value| most.max(value.abs()));
    assert!(greatest > 1e-3);
    let mut near = 0;
    for (at, row) in found.iter().enumerate() {
        let difference = |plus: usize, axis: usize| {
            (gradients[plus][at][2 + axis] - gradients[plus + 1][at][2 + axis]) / (2.0 * H)
        };
        let expected = [difference(0, 0), difference(0, 1), difference(2, 1)];
        near += usize::from((0..3).all(|place| (row[2 + place] - expected[place]).abs() < 1e-7));
        assert!((difference(2, 0) - difference(0, 1)).abs() < 1e-6 || near < at + 1, "{row:?}");
    }
    // Second derivatives jump at knot lines, which a few sites are next to.
    assert!(near >= 195, "{near}");
}

#[test]
fn splines_of_degree_1_have_no_second_derivatives() {
    let folder = Folder::new();
    let (knots, points) =
        (folder.write("knots.txt", knots()), folder.write("points.txt", points(2_000, 2, bowl)));
    let set = run("configgen", &["--degree", "0", &knots], &[]).stdout;
    let linear = output(&["fit", "--degree", "1", "--knots", "-", &points], &set);
    let sites = folder.write("sites.txt", table(&SITES[..3]));
    for row in rows(&output(&["eval", "-", "--at", &sites, "--kind", "hessian"], &linear)) {
        assert_eq!(row[2..], [0.0; 3]);
    }
}

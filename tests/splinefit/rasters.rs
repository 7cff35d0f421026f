//! Rasters against values at the centres of their cells.

use std::fs::File;
use std::io::BufReader;

use tiff::decoder::{Decoder, DecodingResult};

use super::{output, points, rows};
use crate::programs::{Folder, outcome, run};

/// A spline over the convex hull of a few points: its knots lie in a disk.
fn disk() -> Vec<u8> {
    let folder = Folder::new();
    let at = |i: usize, ring: f64| {
        let angle = 0.1 + i as f64 * std::f64::consts::TAU / 12.0 + 0.02 * (i * i % 5) as f64;
        format!("{} {}\n", 50.0 + ring * angle.cos(), 40.0 + ring * angle.sin())
    };
    let knots: String =
        [35.0, 22.0, 9.0].iter().flat_map(|&ring| (0..12).map(move |i| at(i, ring))).collect();
    let points = points(6_000, 3, |x, y| 100.0 + (0.1 * x).sin() * (0.08 * y).cos() + 0.02 * x);
    let (knots, points) = (folder.write("knots.txt", knots), folder.write("points.txt", points));
    output(&["fit", "--knots", &knots, &points], &[])
}

/// Columns and rows; left, bottom and step; and values of an ESRI grid.
fn grid(text: &[u8]) -> ([usize; 2], [f64; 3], Vec<f32>) {
    let text = std::str::from_utf8(text).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let head = |line: usize| lines[line].split(' ').nth(1).unwrap();
    let counts = [0, 1].map(|line| head(line).parse().unwrap());
    let place = [2, 3, 4].map(|line| head(line).parse().unwrap());
    (
        counts,
        place,
        lines[6..].iter().flat_map(|line| line.split(' ')).map(|word| word.parse().unwrap()).collect(),
    )
}

#[test]
fn cells_have_what_is_at_their_centres() {
    let (folder, spline) = (Folder::new(), disk());
    let spline = folder.write("spline.spm", spline);
    for kind in ["value", "slope", "aspect", "profile-curvature", "tangential-curvature"] {
        let ([columns, count], [left, bottom, step], values) =
            grid(&output(&["eval", &spline, "--step", "1.5", "--kind", kind, "--format", "asc"], &[]));
        assert_eq!(columns * count, values.len());
        // The sides of the raster are at multiples of the step.
        assert_eq!((left / step).fract(), 0.0);
        let centre = |cell: usize| {
            let (column, row) = (cell % columns, count - 1 - cell / columns);
            [left + (column as f64 + 0.5) * step, bottom + (row as f64 + 0.5) * step]
        };
        let centres = (0..values.len()).map(centre).map(|[x, y]| format!("{x} {y}\n")).collect::<String>();
        let sites = folder.write("sites.txt", centres);
        let single = rows(&output(&["eval", &spline, "--at", &sites, "--kind", kind], &[]));
        let mut outside = 0;
        for (value, row) in values.iter().zip(&single) {
            if row[2].is_nan() {
                outside += 1;
                assert_eq!(*value, -9999.0);
            } else {
                assert!(
                    (f64::from(*value) - row[2]).abs() <= 1e-5 * row[2].abs().max(1e-3),
                    "{kind} {row:?}: {value}"
                );
            }
        }
        // The corners of the box of a disk are outside of the domain.
        let part = f64::from(outside) / values.len() as f64;
        assert!((0.15..0.35).contains(&part), "{kind}: {part}");
    }
}

#[test]
fn formats_hold_the_same() {
    let (folder, spline) = (Folder::new(), disk());
    let spline = folder.write("spline.spm", spline);
    // More columns than a tile has, and more rows than a band.
    let [tif, asc] = ["x.tif", "x.asc"].map(|name| folder.path(name));
    for file in [&tif, &asc] {
        let found = run("splinefit", &["eval", &spline, "--columns", "300", "-o", file], &[]);
        let (code, message) = outcome(&found);
        assert_eq!(code, Some(0), "{message}");
        assert!(message.contains("300 by ") && message.contains("without data"), "{message}");
    }
    let ([columns, count], [left, bottom, step], values) = grid(&std::fs::read(&asc).unwrap());
    let mut decoder = Decoder::new(BufReader::new(File::open(&tif).unwrap())).unwrap();
    assert_eq!(decoder.dimensions().unwrap(), (columns as u32, count as u32));
    let DecodingResult::F32(decoded) = decoder.read_image().unwrap() else { panic!("no floats") };
    assert_eq!(decoded, values);
    assert_eq!(columns, 300);
    // The table has the cells in the domain, in the same order.
    let table = rows(&output(&["eval", &spline, "--columns", "300"], &[]));
    let known: Vec<(usize, f32)> = values.into_iter().enumerate().filter(|cell| cell.1 != -9999.0).collect();
    assert_eq!(table.len(), known.len());
    let top = bottom + count as f64 * step;
    for (row, (cell, value)) in table.iter().zip(known) {
        assert!((row[2] - f64::from(value)).abs() < 1e-4);
        let centre =
            [left + ((cell % columns) as f64 + 0.5) * step, top - ((cell / columns) as f64 + 0.5) * step];
        assert!(
            (row[0] - centre[0]).abs() < 1e-6 && (row[1] - centre[1]).abs() < 1e-6,
            "{row:?}, {centre:?}"
        );
    }
}

#[test]
fn windows_and_counts_say_which_cells_there_are() {
    let spline = disk();
    let of = |arguments: &[&str]| {
        let (counts, place, values) =
            grid(&output(&[&["eval", "-", "--format", "asc"], arguments].concat(), &spline));
        assert!(values.iter().all(|value| (99.0..104.0).contains(value) || *value == -9999.0));
        (counts, place)
    };
    assert_eq!(of(&["--bounds", "40,30,60,50", "--step", "2.5"]), ([8, 8], [40.0, 30.0, 2.5]));
    assert_eq!(of(&["--bounds", "40,30,60,50", "--rows", "7"]).0, [7, 7]);
    assert_eq!(of(&["--bounds", "40,30,60,40", "--columns", "100"]).0, [100, 50]);
    let (counts, _) = of(&[]);
    assert_eq!(counts.into_iter().max(), Some(1_000));
    // The window lies outside of the domain.
    assert_eq!(of(&["--bounds", "-40,-30,-20,-10", "--rows", "3"]).0, [3, 3]);
}

//! Points and knots in other formats, and coordinates far from the origin.

use super::{bowl, knots, output, points, rows, stats};
use crate::programs::{Folder, outcome, run, sample};

#[test]
fn a_tile_of_lidar_becomes_a_spline() {
    let folder = Folder::new();
    let tile = sample("lareunion.laz");
    let spline = folder.path("tile.spm");
    let found = run("splinefit", &["fit", "--max-knots", "100", &tile, "-o", &spline], &[]);
    let (code, message) = outcome(&found);
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("(at most 100)"), "{message}");
    // The file is a stream of splines with a domain.
    let header = run("spinfo", &["--json", &spline], &[]);
    let header: serde_json::Value = serde_json::from_slice(&header.stdout).unwrap();
    assert_eq!(header["kind"], "splines");
    let table = rows(&output(&["eval", &spline, "--columns", "20"], &[]));
    assert!(table.len() > 200);
}

#[test]
fn stored_grids_are_the_same_as_the_world() {
    let folder = Folder::new();
    let far = |x: f64, y: f64| bowl(x - 500_000.0, y - 5_400_000.0);
    let moved = |text: String| -> String {
        let line = |line: &str| {
            let numbers: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
            let [x, y] = [0, 1].map(|i| (numbers[i] * 8.0).round() / 8.0);
            let (x, y) = (x + 500_000.0, y + 5_400_000.0);
            format!("{x} {y} {}\n", far(x, y))
        };
        text.lines().map(line).collect()
    };
    let (knots, points) = (
        folder.write("knots.txt", moved(knots())),
        folder.write("points.txt", moved(points(3_000, 2, bowl))),
    );
    let scale = ["--scale", "0.125,0.125,0.125", "--offset", "500000,5400000,0"];
    let stored = folder.path("knots.spm");
    assert!(run("spfinalize", &[&scale[..], &[&knots, "-o", &stored]].concat(), &[]).status.success());
    for knots in [&knots, &stored] {
        for lambda in [&[][..], &["--lambda", "2.5"]] {
            let spline = output(&[&["fit", "--knots", knots, &points], lambda].concat(), &[]);
            let found = rows(&output(&["eval", "-", "--at", &points], &spline));
            let deviations = found.iter().map(|row| (row[2] - far(row[0], row[1])).abs());
            let greatest = deviations.fold(0.0, f64::max);
            assert!(greatest < if lambda.is_empty() { 1e-7 } else { 0.5 }, "{knots} {lambda:?}: {greatest}");
        }
    }
    // Smoothing is in world units.
    let of = |knots: &str| {
        let counted = stats(&["--knots", knots, "--lambda", "50", &points], &[]);
        ["residual_max", "residual_rms"].map(|key| counted[key].as_f64().unwrap())
    };
    let (world, grid) = (of(&knots), of(&stored));
    for (a, b) in world.into_iter().zip(grid) {
        assert!((a / b - 1.0).abs() < 1e-6, "{a}, {b}");
    }
    let slopes = |knots: &str| {
        let spline = output(&["fit", "--knots", knots, &points], &[]);
        rows(&output(&["eval", "-", "--at", &points, "--kind", "gradient"], &spline))
    };
    for (a, b) in slopes(&knots).iter().zip(slopes(&stored)) {
        assert!((a[2] - b[2]).abs() < 1e-7 && (a[3] - b[3]).abs() < 1e-7, "{a:?}, {b:?}");
    }
}

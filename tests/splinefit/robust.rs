//! Gross errors, and lists of points.

use super::{deviation, knots, output, plane, points, rows, stats};
use crate::programs::{Folder, outcome, run};

/// Points of a plane, every twentieth of them far above it.
fn with_errors() -> (String, Vec<usize>) {
    let all = points(4_000, 12, plane);
    let far: Vec<usize> = (0..4_000).filter(|i| i % 20 == 7).collect();
    let line = |(i, line): (usize, &str)| {
        let mut words: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
        words[2] += if i % 20 == 7 { 5.0 + (i % 9) as f64 } else { 1e-3 * ((i % 7) as f64 - 3.0) };
        format!("{} {} {}\n", words[0], words[1], words[2])
    };
    (all.lines().enumerate().map(line).collect(), far)
}

#[test]
fn gross_errors_are_rejected_and_listed() {
    let folder = Folder::new();
    let (text, far) = with_errors();
    let (knots, points) = (folder.write("knots.txt", knots()), folder.write("points.txt", &text));
    let plain = output(&["fit", "--knots", &knots, &points], &[]);
    assert!(deviation(&plain, plane) > 0.1);
    for loss in ["huber", "tukey"] {
        let list = folder.path("rejected.txt");
        let arguments = ["fit", "--knots", &knots, "--robust", loss, "--rejected", &list, &points];
        let found = run("splinefit", &arguments, &[]);
        let (code, message) = outcome(&found);
        assert_eq!(code, Some(0), "{loss}: {message}");
        assert!(message.contains("200 of 4000 points rejected"), "{loss}: {message}");
        assert!(deviation(&found.stdout, plane) < 0.02, "{loss}");
        let rejected = rows(&std::fs::read(&list).unwrap());
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(rejected.len(), far.len());
        for (row, &index) in rejected.iter().zip(&far) {
            // The rejected point is written with all its digits.
            assert_eq!(format!("{} {} {}", row[0], row[1], row[2]), lines[index]);
            assert!((row[3] - (row[2] - plane(row[0], row[1]))).abs() < 0.02);
        }
    }
}

#[test]
fn residuals_are_listed_in_order() {
    let folder = Folder::new();
    let (text, _) = with_errors();
    // One additional point outside of the domain.
    let text = text + "500 500 0\n";
    let (knots, points) = (folder.write("knots.txt", knots()), folder.write("points.txt", &text));
    let list = folder.path("residuals.txt");
    let found = run("splinefit", &["fit", "--knots", &knots, "--residuals", &list, &points], &[]);
    assert!(outcome(&found).1.contains("1 of 4001 points are outside"), "{:?}", outcome(&found));
    let residuals = rows(&std::fs::read(&list).unwrap());
    let lines: Vec<&str> = text.lines().take(4_000).collect();
    let values = rows(&output(&["eval", "-", "--at", &points], &found.stdout));
    assert_eq!((residuals.len(), values.len()), (4_000, 4_001));
    assert!(values[4_000][2].is_nan());
    for ((row, line), value) in residuals.iter().zip(lines).zip(&values) {
        assert_eq!(format!("{} {} {}", row[0], row[1], row[2]), line);
        assert!((row[2] - value[2] - row[3]).abs() < 1e-9);
    }
}

#[test]
fn gross_errors_attract_no_knots() {
    let wave = |x: f64, y: f64| (0.1 * x).sin() * (0.08 * y).cos();
    let line = |(i, line): (usize, &str)| {
        let mut words: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
        words[2] += if i % 100 == 7 { [20.0, -35.0, 50.0][i % 3] } else { 1e-3 * ((i % 7) as f64 - 3.0) };
        format!("{} {} {}\n", words[0], words[1], words[2])
    };
    let text: String = points(20_000, 12, wave).lines().enumerate().map(line).collect();
    let flags = ["--tol", "0.02", "--max-knots", "1000"];
    let plain = stats(&flags, text.as_bytes());
    let arguments = [&["fit", "--stats=json", "-q", "--robust", "tukey"], &flags[..]].concat();
    let found = run("splinefit", &arguments, text.as_bytes());
    let (code, message) = outcome(&found);
    assert_eq!(code, Some(0), "{message}");
    let robust: serde_json::Value = serde_json::from_str(&message).unwrap();
    let knots = |counted: &serde_json::Value| counted["knots"].as_u64().unwrap();
    assert!(knots(&plain) > 900, "{plain}");
    assert!(knots(&robust) < 300 && robust["is_reached"] == 1, "{robust}");
    let spline = found.stdout;
    let folder = Folder::new();
    let sites = folder.write("sites.txt", points(500, 31, wave));
    let found = rows(&output(&["eval", "-", "--at", &sites], &spline));
    let inside: Vec<_> = found.iter().filter(|row| !row[2].is_nan()).collect();
    assert!(inside.len() > 480);
    assert!(inside.iter().all(|row| (row[2] - wave(row[0], row[1])).abs() < 0.03));
}

//! How sure splines are: standard errors, prediction errors and cross-validation.

use super::automatic::{franke, noise, sample, text};
use super::{output, rows};
use crate::programs::{Folder, outcome, run};
use spmesh_reference::sets::Random;

#[test]
fn prediction_errors_hold_as_often_as_they_say() {
    let noisy = |x: f64, y: f64, random: &mut Random| franke(x, y) + 0.1 * noise(random);
    let (points, others) = (sample(400, 15, noisy), sample(400, 16, noisy));
    let folder = Folder::new();
    let fitted = folder.write("points.txt", text(&points));
    let spline = folder.path("spline.spm");
    output(&["fit", "-q", &fitted, "-o", &spline], &[]);
    let sites = folder.write("sites.txt", text(&others));
    let of = |kind: &str| {
        let flags = ["eval", &spline, "--at", &sites, "--kind", kind];
        let more: &[&str] = if kind == "value" { &[] } else { &["--points", &fitted] };
        rows(&output(&[&flags[..], more].concat(), &[]))
    };
    let [value, own, whole] = ["value", "standard-error", "prediction-error"].map(of);
    let (mut held, mut all) = (0, 0);
    for (at, [.., z]) in others.iter().enumerate().filter(|&(at, _)| !value[at][2].is_nan()) {
        let [value, own, whole] = [&value, &own, &whole].map(|rows| rows[at][2]);
        assert!(0.0 < own && own < 0.1 && (0.09..0.15).contains(&whole), "{own} {whole}");
        (held, all) = (held + usize::from((value - z).abs() < 1.96 * whole), all + 1);
    }
    assert!(all > 380 && (0.93..0.97).contains(&(f64::from(held as u32) / f64::from(all as u32))), "{held}");
    // They follow from the points of the fit.
    let refused = |arguments: &[&str], reason: &str| {
        let (code, message) = outcome(&run("splinefit", arguments, &[]));
        assert_eq!(code, Some(2), "{message}");
        assert!(message.contains(reason), "{message}");
    };
    refused(&["eval", &spline, "--at", &sites, "--kind", "standard-error"], "give them with --points");
    refused(&["eval", &spline, "--at", &sites, "--points", &fitted], "leave it out");
    let flags = ["eval", &spline, "--at", &sites, "--kind", "standard-error", "--points", &sites];
    refused(&flags, "not a fit to these points");
}

#[test]
fn errors_of_stiff_splines_are_those_of_linear_regression() {
    // With so much smoothing, a spline is a plane.
    let points = sample(60, 21, |x, y, random| 0.3 * x - 0.2 * y + 0.05 * noise(random));
    let folder = Folder::new();
    let (path, sites) =
        (folder.write("points.txt", text(&points)), folder.write("sites.txt", "0.3 0.6\n0.5 0.4\n"));
    let spline = folder.path("spline.spm");
    output(&["fit", "-q", "--step", "0.5", "--lambda", "1e4", &path, "-o", &spline], &[]);
    let of = |kind: &str| {
        let flags = ["eval", &spline, "--at", &sites, "--kind", kind, "--points", &path];
        let flags = if kind == "gradient" { &flags[..6] } else { &flags[..] };
        rows(&output(flags, &[]))
    };
    let [own, slope, gradient] = ["standard-error", "slope-error", "gradient"].map(of);
    // The inverse of the sums of products of 1, x and y.
    let sum = |f: &dyn Fn(&[f64; 3]) -> f64| points.iter().map(f).sum::<f64>();
    let count = points.len() as f64;
    let [x, y] = [0, 1].map(|axis| sum(&|p| p[axis]) / count);
    let [a, b, c] = [[0, 0], [0, 1], [1, 1]].map(|[i, j]| sum(&|p| (p[i] - [x, y][i]) * (p[j] - [x, y][j])));
    let inverse = |[u, v]: [f64; 2]| (c * u * u - 2.0 * b * u * v + a * v * v) / (a * c - b * b);
    let [p, q] = [2, 3].map(|at| gradient[0][at]);
    let z = sum(&|p| p[2]) / count;
    let square = sum(&|at| (at[2] - z - p * (at[0] - x) - q * (at[1] - y)).powi(2));
    let noise = (square / (count - 3.0)).sqrt();
    for (row, slope) in own.iter().zip(&slope) {
        let expected = noise * (1.0 / count + inverse([row[0] - x, row[1] - y])).sqrt();
        assert!((row[2] / expected - 1.0).abs() < 1e-3, "{row:?}, {expected}");
        let steepness = p.hypot(q);
        let expected = noise * inverse([p / steepness, q / steepness]).sqrt() / (1.0 + steepness * steepness);
        assert!((slope[2] / expected.to_degrees() - 1.0).abs() < 1e-3, "{slope:?}, {expected}");
    }
}

#[test]
fn cross_validation_predicts_points_from_others() {
    let noisy = |x: f64, y: f64, random: &mut Random| franke(x, y) + 0.1 * noise(random);
    let points = sample(240, 22, noisy);
    let folder = Folder::new();
    let (path, list) = (folder.write("points.txt", text(&points)), folder.path("predictions.txt"));
    for (validation, least) in [("10", 235), ("blocks:0.2", 200), ("one", 240)] {
        let flags = ["fit", "--stats=json", "--cross-validate", validation, "--predictions", &list, &path];
        let run = run("splinefit", &flags, &[]);
        let (code, message) = outcome(&run);
        assert_eq!(code, Some(0), "{message}");
        assert!(message.contains("cross-validation of "), "{message}");
        let found = rows(&std::fs::read(&list).unwrap());
        assert!(found.len() >= least, "{validation}: {}", found.len());
        let off: Vec<f64> = found.iter().map(|row| row[2] - row[3]).collect();
        let rms = (off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64).sqrt();
        // The noise, and errors of the surface, which grow towards the border.
        assert!((0.095..0.13).contains(&rms), "{validation}: {rms}");
        let held = found.iter().filter(|row| (row[5]..=row[6]).contains(&row[2])).count();
        assert!((0.92..=0.98).contains(&(held as f64 / found.len() as f64)), "{validation}: {held}");
        for row in &found {
            assert!(points.iter().any(|point| point[..] == row[..3]), "{row:?}");
            assert!(row[4] > 0.09 && row[5] < row[3] && row[3] < row[6], "{row:?}");
        }
    }
    // One point left out, by another fit with the same knots and smoothing.
    let spline = folder.path("spline.spm");
    let knots = ["--step", "0.25", "--lambda", "0.003"];
    output(
        &[
            &["fit", "-q", "-o", &spline, "--cross-validate", "one", "--predictions", &list, &path][..],
            &knots,
        ]
        .concat(),
        &[],
    );
    let found = rows(&std::fs::read(&list).unwrap());
    for at in [7, 100, 230] {
        let others: Vec<[f64; 3]> =
            (0..240).filter(|&other| other != at).map(|other| points[other]).collect();
        let fit = ["fit", "-q", "--knots", &spline, "--lambda", "0.003", "-"];
        let other = output(&fit, text(&others).as_bytes());
        let site = folder.write("site.txt", text(&points[at..=at]));
        let expected = rows(&output(&["eval", "-", "--at", &site], &other))[0][2];
        assert!((found[at][3] - expected).abs() < 1e-7, "{at}: {}, {expected}", found[at][3]);
    }
    let (code, message) = outcome(&run("splinefit", &["fit", "--cross-validate", "1", &path], &[]));
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("expected 2 to 100 folds, blocks, blocks:SIDE or one"), "{message}");
}

#[test]
fn intervals_hold_as_many_as_they_say_where_errors_are_not_normal() {
    // One in ten points has five times the noise of others.
    let heavy = |x: f64, y: f64, random: &mut Random| {
        let size = if random.unit() < 0.1 { 0.25 } else { 0.05 };
        franke(x, y) + size * noise(random)
    };
    let (points, others) = (sample(600, 23, heavy), sample(1_000, 24, heavy));
    let folder = Folder::new();
    let (path, spline) = (folder.write("points.txt", text(&points)), folder.path("spline.spm"));
    let sites = folder.write("sites.txt", text(&others));
    output(&["fit", "-q", &path, "-o", &spline], &[]);
    let found =
        rows(&output(&["eval", &spline, "--at", &sites, "--kind", "interval", "--points", &path], &[]));
    let inside = |(row, other): &(&Vec<f64>, &[f64; 3])| (row[2]..=row[3]).contains(&other[2]);
    let known: Vec<_> = found.iter().zip(&others).filter(|(row, _)| !row[2].is_nan()).collect();
    let held = known.iter().filter(|pair| inside(pair)).count() as f64 / known.len() as f64;
    assert!(known.len() > 950 && (0.93..0.97).contains(&held), "{held}");
}

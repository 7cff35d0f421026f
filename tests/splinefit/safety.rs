//! Smoothing that is chosen: gaps in the points, gross errors, and warnings.

use super::{mean_deviation, output, points, stats};
use crate::programs::{Folder, outcome, run};
use spmesh_reference::sets::Random;

fn hills(x: f64, y: f64) -> f64 {
    500.0 + 4.0 * (0.1 * x).sin() + 3.0 * (0.08 * y).cos()
}

/// Points with noise, in clusters that leave gaps between them; some have gross errors.
fn gappy(count: usize, error_every: usize) -> String {
    let mut random = Random::new(31);
    let is_kept = |x: f64, y: f64| (0.23 * x).sin() * (0.31 * y).sin() > -0.1;
    // The corners make the domain the whole box.
    let corners = [(0.0, 0.0), (100.0, 0.0), (0.0, 80.0), (100.0, 80.0)];
    let corners: String = corners.map(|(x, y)| format!("{x} {y} {}\n", hills(x, y))).concat();
    let all = points(count, 6, hills);
    let kept = all.lines().map(|line| -> Vec<f64> { line.split(' ').map(|w| w.parse().unwrap()).collect() });
    let lines: String = kept
        .filter(|row| is_kept(row[0], row[1]))
        .enumerate()
        .map(|(i, row)| {
            let error = if error_every > 0 && i % error_every == 3 { 8.0 + (i % 13) as f64 } else { 0.0 };
            format!("{} {} {}\n", row[0], row[1], row[2] + 0.1 * (random.unit() - 0.5) + error)
        })
        .collect();
    corners + &lines
}

/// The finer knots have several functions for each point.
#[test]
fn every_choice_bridges_gaps() {
    try_gaps(&["1.6", "3"]);
}

#[test]
#[ignore = "long: run with -- --ignored"]
fn every_choice_bridges_gaps_of_many_knots() {
    try_gaps(&["1", "2"]);
}

fn try_gaps(steps: &[&str]) {
    let folder = Folder::new();
    let points = folder.write("points.txt", gappy(3_000, 0));
    for lambda in ["reml", "gcv", "cv"] {
        for &step in steps {
            let said = stats(&["--step", step, "--lambda", lambda, &points], &[]);
            let range = [0, 1].map(|at| said["range"][at].as_f64().unwrap());
            let extent = ["least", "greatest"].map(|end| said["extent"][end]["value"].as_f64().unwrap());
            let whole = range[1] - range[0];
            let is_near = extent[0] > range[0] - 0.25 * whole && extent[1] < range[1] + 0.25 * whole;
            assert!(is_near, "{lambda} {step}: {extent:?}, {range:?}");
            assert_eq!(said["failed_trials"].as_array().unwrap().len(), 0, "{lambda} {step}");
        }
    }
}

#[test]
fn splines_that_leave_the_range_are_named() {
    let folder = Folder::new();
    // All points are in two corners, and their slopes would meet far below.
    let two: String = (0..400)
        .map(|i| (f64::from(i % 20) * 0.25, f64::from(i / 20) * 0.25))
        .flat_map(|(x, y)| [(x, y, -x - y), (100.0 - x, 80.0 - y, -x - y)])
        .map(|(x, y, z)| format!("{x} {y} {z}\n"))
        .collect();
    let points = folder.write("points.txt", two);
    let spline = folder.path("spline.spm");
    let found = run("splinefit", &["fit", "--step", "5", "--lambda", "1e-3", &points, "-o", &spline], &[]);
    let (code, message) = outcome(&found);
    assert_eq!(code, Some(0), "{message}");
    assert!(
        message.contains("warning: the spline is -") && message.contains("between -9.5 and 0"),
        "{message}"
    );
    let found = run("splinefit", &["info", &spline, &points], &[]);
    let text = String::from_utf8(found.stdout.clone()).unwrap();
    assert!(text.contains("elevations   from -9.5 to 0; the spline leaves this range by"), "{text}");
    assert!(outcome(&found).1.contains("warning: the spline is -"));
    // The place that is named has the value that is named.
    let json: serde_json::Value =
        serde_json::from_slice(&output(&["info", "--json", "-q", &spline, &points], &[])).unwrap();
    let excess = &json["residuals"]["excess"];
    let [x, y] = [0, 1].map(|axis| excess["at"][axis].as_f64().unwrap());
    let site = folder.write("site.txt", format!("{x} {y}\n"));
    let value = super::rows(&output(&["eval", &spline, "--at", &site], &[]))[0][2];
    assert!((value - excess["value"].as_f64().unwrap()).abs() < 1e-9 * value.abs(), "{value}, {excess}");
    // No cell of a raster is lower.
    let cells = super::rows(&output(&["eval", &spline, "--step", "0.5", "--format", "text"], &[]));
    let least = cells.iter().map(|row| row[2]).fold(f64::INFINITY, f64::min);
    assert!(least > value + 1e-3 * value && least < 0.9 * value, "{least}, {value}");
    assert!(value < -15.0 && json["extent"]["least"]["value"] == excess["value"]);
}

/// Each choice, each loss, and both losses with the usual choice.
#[test]
fn lambda_is_chosen_with_robust_weights() {
    try_losses(&[("reml", &["huber", "tukey"]), ("gcv", &["huber"]), ("cv", &["tukey"])]);
}

#[test]
#[ignore = "long: run with -- --ignored"]
fn lambda_is_chosen_with_robust_weights_of_every_loss() {
    let losses = &["huber", "tukey"][..];
    try_losses(&[("reml", losses), ("gcv", losses), ("cv", losses)]);
}

fn try_losses(choices: &[(&str, &[&str])]) {
    let folder = Folder::new();
    let clean = folder.write("clean.txt", gappy(2_000, 0));
    let spoilt = folder.write("spoilt.txt", gappy(2_000, 20));
    let of = |flags: &[&str], points: &str| {
        let spline = output(&[&["fit", "--step", "2"], flags, &[points]].concat(), &[]);
        mean_deviation(&spline, hills)
    };
    for (lambda, losses) in choices {
        let best = of(&["--lambda", lambda], &clean);
        for loss in *losses {
            let found = of(&["--lambda", lambda, "--robust", loss], &spoilt);
            assert!(found < 1.5 * best, "{lambda} {loss}: {found}, {best}");
        }
        assert!(of(&["--lambda", lambda], &spoilt) > 5.0 * best, "{lambda}");
    }
}

#[test]
fn constant_elevations_need_no_warning() {
    let folder = Folder::new();
    let points = folder.write("points.txt", points(800, 9, |_, _| 0.1));
    let found = run("splinefit", &["fit", "--step", "7", &points], &[]);
    let (code, message) = outcome(&found);
    assert_eq!(code, Some(0), "{message}");
    assert!(!message.contains("warning"), "{message}");
}

#[test]
fn the_finest_knots_keep_the_smoothing_of_fewer() {
    let folder = Folder::new();
    // Waves that are half as long are as noise to these points, which are 3.7 apart: fewer knots predict
    // better.
    let rough = points(600, 11, |x, y| hills(x, y) + (0.45 * x).sin() * (0.4 * y).cos());
    let (points, spline) = (folder.write("points.txt", rough), folder.path("spline.spm"));
    output(&["fit", "-q", &points, "-o", &spline], &[]);
    let found = stats(&[&points], &[]);
    assert_eq!(found["stop"], "density");
    // Four knots for each point, each with about two functions.
    let functions = found["functions"].as_u64().unwrap();
    assert!(functions > 6 * 600, "{functions}");
    let [lambda, tension] = ["lambda", "tension"].map(|name| found[name].to_string());
    let same = stats(&["--knots", &spline, "--lambda", &lambda, "--tension", &tension, &points], &[]);
    for name in ["residual_rms", "residual_max"] {
        let [one, other] = [&found, &same].map(|said| said[name].as_f64().unwrap());
        assert!((one - other).abs() < 1e-6 * one, "{name}: {one}, {other}");
    }
    assert_eq!(found["functions"], same["functions"]);
}

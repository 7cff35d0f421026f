//! `splinefit`: splines fitted to points, and their values at sites and in cells, against known functions.

mod arrays;
mod automatic;
mod certainty;
mod collocation;
mod failures;
mod features;
mod info;
mod jumps;
mod rasters;
mod robust;
mod safety;
mod sources;
mod tables;

use serde_json::Value;

use crate::programs::{Folder, outcome, run};
use spmesh_reference::sets::Random;

/// The output of `splinefit`, which must succeed.
fn output(arguments: &[&str], input: &[u8]) -> Vec<u8> {
    let output = run("splinefit", arguments, input);
    assert!(output.status.success(), "{arguments:?}: {:?}", outcome(&output));
    output.stdout
}

/// The statistics of a fit.
fn stats(arguments: &[&str], input: &[u8]) -> Value {
    let output =
        run("splinefit", &[&["fit", "--stats=json", "-q", "-o", "/dev/null"], arguments].concat(), input);
    let (code, message) = outcome(&output);
    assert_eq!(code, Some(0), "{arguments:?}: {message}");
    serde_json::from_str(&message).unwrap()
}

/// The numbers in the lines of a table.
fn rows(table: &[u8]) -> Vec<Vec<f64>> {
    let text = std::str::from_utf8(table).unwrap();
    let numbers = |line: &str| line.split(' ').map(|word| word.parse().unwrap()).collect();
    text.lines().filter(|line| !line.starts_with('#')).map(numbers).collect()
}

/// Points in a box of 100 by 80 with the elevations of a function, as text.
fn points(count: usize, seed: u64, f: impl Fn(f64, f64) -> f64) -> String {
    let mut random = Random::new(seed);
    let mut point = || (100.0 * random.unit(), 80.0 * random.unit());
    (0..count).map(|_| point()).map(|(x, y)| format!("{x} {y} {}\n", f(x, y))).collect()
}

/// Sites in the same box.
fn sites(count: usize) -> String {
    points(count, 99, |_, _| 0.0)
}

/// Knots of a grid over the box; inner knots are moved off it.
fn knots() -> String {
    let mut random = Random::new(5);
    let mut lines = String::new();
    for (i, j) in (0..=5).flat_map(|j| (0..=5).map(move |i| (i, j))) {
        let is_inside = (1..5).contains(&i) && (1..5).contains(&j);
        let mut moved = |k: i32| f64::from(k) + if is_inside { 0.3 * (random.unit() - 0.5) } else { 0.0 };
        lines += &format!("{} {}\n", 20.0 * moved(i), 16.0 * moved(j));
    }
    lines
}

fn plane(x: f64, y: f64) -> f64 {
    500.0 + 0.25 * x - 0.5 * y
}

fn bowl(x: f64, y: f64) -> f64 {
    3.0 + 0.01 * x * x - 0.02 * x * y + 0.03 * y * y - y
}

/// The greatest deviation of the spline in a stream from a function, at sites that must all be in the domain.
fn deviation(spline: &[u8], f: impl Fn(f64, f64) -> f64) -> f64 {
    let greater = |greatest: f64, one: f64| if one.is_nan() { f64::INFINITY } else { greatest.max(one) };
    deviations(spline, f).into_iter().fold(0.0, greater)
}

/// The root mean square deviation.
fn mean_deviation(spline: &[u8], f: impl Fn(f64, f64) -> f64) -> f64 {
    let all = deviations(spline, f);
    (all.iter().map(|off| off * off).sum::<f64>() / all.len() as f64).sqrt()
}

fn deviations(spline: &[u8], f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let folder = Folder::new();
    let sites = folder.write("sites.txt", sites(500));
    let found = rows(&output(&["eval", "-", "--at", &sites], spline));
    assert_eq!(found.len(), 500);
    found.iter().map(|row| (row[2] - f(row[0], row[1])).abs()).collect()
}

#[test]
fn a_plane_is_given_back_without_any_option() {
    let spline = output(&["fit"], points(2_000, 1, plane).as_bytes());
    // The box of the points is almost as large as that of the sites.
    let folder = Folder::new();
    let sites = folder.write("sites.txt", points(300, 4, |_, _| 0.0));
    let found = rows(&output(&["eval", "-", "--at", &sites], &spline));
    let inside: Vec<_> = found.iter().filter(|row| !row[2].is_nan()).collect();
    assert!(inside.len() > 290, "{}", inside.len());
    for row in inside {
        assert!((row[2] - plane(row[0], row[1])).abs() < 1e-9, "{row:?}");
    }
    let counted = stats(&[], points(2_000, 1, plane).as_bytes());
    assert_eq!((&counted["stop"], &counted["degree"]), (&"rounding".into(), &2.into()));
    assert_eq!(counted["outside"], 0);
}

#[test]
fn quadratics_are_given_back_over_given_knots() {
    let folder = Folder::new();
    let (knots, points) =
        (folder.write("knots.txt", knots()), folder.write("points.txt", points(3_000, 2, bowl)));
    let spline = output(&["fit", "--knots", &knots, &points], &[]);
    assert!(deviation(&spline, bowl) < 1e-9);
    // Slopes and curvatures are those of the function.
    let sites = folder.write("sites.txt", sites(200));
    let of = |kind: &str| rows(&output(&["eval", "-", "--at", &sites, "--kind", kind], &spline));
    let all = ["gradient", "slope", "aspect", "profile-curvature", "tangential-curvature"].map(of);
    for at in 0..200 {
        let [x, y] = [all[0][at][0], all[0][at][1]];
        let (p, q, r, s, t) = (0.02 * x - 0.02 * y, -0.02 * x + 0.06 * y - 1.0, 0.02, -0.02, 0.06);
        let square = p * p + q * q;
        let expected = [
            p,
            q,
            square.sqrt().atan().to_degrees(),
            (90.0 - (-q).atan2(-p).to_degrees()).rem_euclid(360.0),
            -(p * p * r + 2.0 * p * q * s + q * q * t) / (square * (1.0 + square).powf(1.5)),
            -(q * q * r - 2.0 * p * q * s + p * p * t) / (square * (1.0 + square).sqrt()),
        ];
        let found = all.iter().flat_map(|rows| rows[at][2..].iter());
        for (place, (found, expected)) in found.zip(expected).enumerate() {
            // Second derivatives lose more digits where the slope is small.
            let tolerance = if square < 1e-3 { 1e-3 } else { 1e-5 };
            assert!((found - expected).abs() < tolerance, "{place} at {x} {y}: {found}, {expected}");
        }
    }
}

#[test]
fn configurations_come_through_a_pipe() {
    let folder = Folder::new();
    let (knots, points) =
        (folder.write("knots.txt", knots()), folder.write("points.txt", points(3_000, 2, bowl)));
    let set = run("configgen", &["--boundary", "pulled-apart", &knots], &[]).stdout;
    let spline = output(&["fit", "--knots", "-", &points], &set);
    assert!(deviation(&spline, bowl) < 1e-9);
    // The knots of a spline can be used again: they give the same spline.
    let again = output(&["fit", "--knots", "-", &points], &spline);
    assert_eq!(again, spline);
    let info = run("spinfo", &["--audit", "-"], &spline);
    assert!(info.status.success(), "{:?}", outcome(&info));
    // The text twin of a spline works, too.
    let twin = run("spconvert", &["--to", "text"], &spline).stdout;
    assert!(deviation(&twin, bowl) < 1e-9);
}

#[test]
fn splines_have_other_degrees() {
    let folder = Folder::new();
    let cubic = |x: f64, y: f64| bowl(x, y) + 1e-4 * x * x * y - 2e-4 * y * y * y;
    let (knots, points) =
        (folder.write("knots.txt", knots()), folder.write("points.txt", points(4_000, 3, cubic)));
    let set = run("configgen", &["--boundary", "clamped", "--degree", "2", &knots], &[]).stdout;
    let spline = output(&["fit", "--degree", "3", "--knots", "-", "--lambda", "1e-6", &points], &set);
    assert!(deviation(&spline, cubic) < 1e-7);
}

#[test]
fn results_do_not_depend_on_threads() {
    let wave = points(20_000, 8, |x, y| (0.2 * x).sin() * (0.15 * y).cos());
    let of = |threads: &str| output(&["fit", "--tol", "0.02", "--threads", threads], wave.as_bytes());
    let one = of("1");
    assert_eq!(one, of("3"));
    let table = |threads: &str| {
        output(&["eval", "-", "--columns", "90", "--format", "asc", "--threads", threads], &one)
    };
    assert_eq!(table("1"), table("4"));
}

#[test]
fn knots_are_added_until_the_tolerance_is_reached() {
    let wave = points(20_000, 8, |x, y| (0.2 * x).sin() * (0.15 * y).cos());
    let counted = stats(&["--tol", "0.02"], wave.as_bytes());
    assert_eq!(counted["is_reached"], 1);
    let greatest = counted["residual_max"].as_f64().unwrap();
    assert!(greatest <= 0.02 && counted["residual_95"].as_f64().unwrap() < greatest, "{counted}");
    let rounds = counted["rounds"].as_array().unwrap();
    assert!(rounds.len() > 2 && rounds[0]["knots"].as_u64() < counted["knots"].as_u64());
    let few = stats(&["--tol", "0.02", "--max-knots", "40"], wave.as_bytes());
    assert_eq!(few["is_reached"], 0);
    assert!(few["knots"].as_u64().unwrap() <= 40);
}

#[test]
fn smoothing_follows_cross_validation() {
    let folder = Folder::new();
    let mut random = Random::new(77);
    let noise: Vec<f64> = (0..3_000).map(|_| 4.0 * (random.unit() - 0.5)).collect();
    let next = std::cell::Cell::new(0);
    let noisy = points(3_000, 2, |x, y| {
        next.set(next.get() + 1);
        plane(x, y) + noise[next.get() - 1]
    });
    let (knots, points) = (folder.write("knots.txt", knots()), folder.write("points.txt", noisy));
    let of = |lambda: &str| {
        let arguments = ["--knots", &knots, "--lambda", lambda, &points];
        (stats(&arguments, &[]), mean_deviation(&output(&[&["fit"], &arguments[..]].concat(), &[]), plane))
    };
    let (_, plain) = of("0");
    for method in ["gcv", "cv", "cv:3"] {
        let (counted, smooth) = of(method);
        assert!(smooth < plain, "{method}: {smooth}, {plain}");
        assert!(counted["lambda"].as_f64().unwrap() > 0.0);
        assert!(counted["trials"].as_array().unwrap().len() > 10);
        // The chosen lambda can be requested.
        let (_, again) = of(&counted["lambda"].to_string());
        assert!((again - smooth).abs() < 1e-6, "{method}: {again}, {smooth}");
    }
}

#[test]
fn gaps_are_bridged() {
    let folder = Folder::new();
    // A quarter of the box has no points.
    let all = points(4_000, 2, plane);
    let some =
        all.lines().filter(|line| !(line.starts_with(|c| "89".contains(c)) && line.find('.') == Some(2)));
    let some: String = some.map(|line| format!("{line}\n")).collect();
    let (knots, points) = (folder.write("knots.txt", knots()), folder.write("points.txt", some));
    let arguments = ["fit", "--knots", &knots, &points];
    let found = run("splinefit", &arguments, &[]);
    let (code, message) = outcome(&found);
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("functions undetermined: these alone are smoothed"), "{message}");
    assert!(deviation(&found.stdout, plane) < 1e-3);
    let (code, message) = outcome(&run("splinefit", &[&arguments[..], &["--lambda", "0"]].concat(), &[]));
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("not determined"), "{message}");
}

#[test]
fn values_of_triangulated_points_are_interpolated() {
    let folder = Folder::new();
    // Linear interpolation of points in a plane gives the plane.
    let around =
        "-1 -1 500.25\n101 -1 525.75\n101 81 484.75\n-1 81 459.25\n".to_string() + &points(300, 6, plane);
    let (knots, around) = (folder.write("knots.txt", knots()), folder.write("points.txt", around));
    let spline = output(&["fit", "--interpolate", "--knots", &knots, &around], &[]);
    assert!(deviation(&spline, plane) < 1e-9);
    let few = folder.write("few.txt", "40 40 1\n60 40 2\n50 60 3\n");
    let (code, message) = outcome(&run("splinefit", &["fit", "--interpolate", "--knots", &knots, &few], &[]));
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("Greville site") && message.contains("hull of the points"), "{message}");
}

#[test]
fn weights_count() {
    let folder = Folder::new();
    let half = points(3_000, 2, plane);
    let wrong: String = points(3_000, 2, |x, y| plane(x, y) + 10.0);
    let weights = "1\n".repeat(3_000) + &"1e-12\n".repeat(3_000);
    let [knots, weights] =
        [("knots.txt", knots()), ("weights.txt", weights)].map(|(name, text)| folder.write(name, text));
    let arguments = ["fit", "--knots", &knots, "--weights", &weights, "-"];
    let spline = output(&arguments, (half.clone() + &wrong).as_bytes());
    assert!(deviation(&spline, plane) < 1e-8);
    let (code, message) = outcome(&run("splinefit", &arguments, half.as_bytes()));
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("6000 weights for 3000 points"), "{message}");
}

#[test]
fn knots_can_be_on_a_grid() {
    let wave = |x: f64, y: f64| (0.1 * x).sin() * (0.08 * y).cos();
    let text = points(20_000, 8, wave);
    let counted = stats(&["--step", "5"], text.as_bytes());
    // 20 by 16 cells, and a few additional knots so that corners are not cut off.
    let knots = counted["knots"].as_u64().unwrap();
    assert!((21 * 17..=21 * 17 + 4).contains(&knots), "{knots}");
    assert!(counted["residual_max"].as_f64().unwrap() < 0.02, "{counted}");
    let (code, message) = outcome(&run("splinefit", &["fit", "--step", "1e-6"], text.as_bytes()));
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("take larger ones"), "{message}");
}

#[test]
fn functions_that_are_zero_are_left_out() {
    let folder = Folder::new();
    // Next to the border, the link of two of these knots goes back and forth between copies at one place, so
    // its B-spline is zero.
    let knots = "938.3889 366.3663\n953.5630 365.1613\n936.2030 431.5693\n934.7009 407.2476\n987.5798 361.0138\n\
                 996.1186 375.6824\n983.6020 385.7561\n999.9800 405.9347\n999.9800 415.8357\n991.0878 410.5905\n\
                 995.8512 415.0531\n993.2535 414.3222\n";
    let mut random = Random::new(4);
    let mut point = || {
        let [x, y] = [934.0 + 66.0 * random.unit(), 361.0 + 71.0 * random.unit()];
        format!("{x} {y} {}\n", plane(x, y))
    };
    let points: String = (0..3_000).map(|_| point()).collect();
    let (knots, points) = (folder.write("knots.txt", knots), folder.write("points.txt", points));
    let counted = stats(&["--knots", &knots, "--lambda", "1", &points], &[]);
    assert_eq!(counted["functions"], 32);
    assert!(counted["residual_max"].as_f64().unwrap() < 1e-6, "{counted}");
}

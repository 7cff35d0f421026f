//! Jumps of values and gradients that `splinefit info` states.

use serde_json::Value;

use super::{bowl, knots, output, points};
use crate::programs::{Folder, run};

fn jumps(spline: &[u8]) -> (Value, Value) {
    let said: Value = serde_json::from_slice(&output(&["info", "--json", "-"], spline)).unwrap();
    let jumps = &said["smoothness"]["jumps"];
    (jumps["value"].clone(), jumps["gradient"].clone())
}

fn greatest(jump: &Value) -> f64 {
    jump["greatest"].as_f64().unwrap()
}

/// Knots off all lines: no three are collinear, and none is repeated.
fn simple_knots() -> String {
    let mut random = spmesh_reference::sets::Random::new(12);
    (0..120).map(|_| format!("{} {}\n", 120.0 * random.unit() - 10.0, 100.0 * random.unit() - 10.0)).collect()
}

#[test]
fn knots_in_general_position_exclude_jumps_exactly() {
    let folder = Folder::new();
    let points = folder.write("points.txt", points(3_000, 2, |x, y| (0.1 * x).sin() * (0.08 * y).cos()));
    let set = run("configgen", &["--degree", "1"], simple_knots().as_bytes()).stdout;
    let spline = output(&["fit", "--knots", "-", "--lambda", "1e-3", &points], &set);
    let (value, gradient) = jumps(&spline);
    let none = serde_json::json!({"exact": true, "segments": 0, "greatest": 0.0, "at": null});
    assert_eq!((&value, &gradient), (&none, &none));
    let text = String::from_utf8(output(&["info", "-"], &spline)).unwrap();
    assert_eq!(text.matches("none (exact: knots exclude it)").count(), 2, "{text}");
    // Configurations have no coefficients, and so no jumps.
    let said: Value = serde_json::from_slice(&output(&["info", "--json", "-"], &set)).unwrap();
    assert!(said["smoothness"]["jumps"].is_null());
}

#[test]
fn creases_have_jumps_of_the_gradient_only() {
    let folder = Folder::new();
    // The slope changes from 0.5 to -0.5 across x = 43.
    let roof = |x: f64, y: f64| 20.0 - 0.5 * (x - 43.0).abs() + 0.1 * y;
    let points = folder.write("points.txt", points(6_000, 3, roof));
    let (knots, ridge) =
        (folder.write("knots.txt", knots()), folder.write("ridge.txt", "crease 43 0 43 80\n"));
    let spline = output(&["fit", "--knots", &knots, "--features", &ridge, &points], &[]);
    let (value, gradient) = jumps(&spline);
    assert!((0.95..1.05).contains(&greatest(&gradient)), "{gradient}");
    assert!((gradient["at"][0].as_f64().unwrap() - 43.0).abs() < 1e-9, "{gradient}");
    assert!(greatest(&value) < 1e-9, "{value}");
    assert_eq!(gradient["exact"], false);
}

#[test]
fn a_polynomial_has_jumps_of_rounding_errors_at_most() {
    let folder = Folder::new();
    let (knots, points) =
        (folder.write("knots.txt", knots()), folder.write("points.txt", points(3_000, 2, bowl)));
    // The border is pulled apart, so knots allow jumps of the gradient next to it.
    let (value, gradient) = jumps(&output(&["fit", "--knots", &knots, &points], &[]));
    assert!(gradient["segments"].as_u64().unwrap() > 0 && greatest(&gradient) < 1e-8, "{gradient}");
    assert!(greatest(&value) < 1e-8, "{value}");
}

#[test]
fn linear_splines_have_jumps_of_the_gradient_at_all_edges() {
    let folder = Folder::new();
    // Four knots around one in the middle: a pyramid, with slopes of 1 on its sides.
    let (knots, points) = (
        folder.write("knots.txt", "-1 -1\n1 -1\n1 1\n-1 1\n0 0\n"),
        folder.write("points.txt", "-1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n0 0 1\n"),
    );
    let set = run("configgen", &["--degree", "0", &knots], &[]).stdout;
    let spline = output(&["fit", "--degree", "1", "--knots", "-", "--lambda", "0", &points], &set);
    let (value, gradient) = jumps(&spline);
    assert!((greatest(&gradient) - 2f64.sqrt()).abs() < 1e-9, "{gradient}");
    assert!(greatest(&value) < 1e-9, "{value}");
    // One diagonal is a line through three knots, and the other consists of two segments.
    assert_eq!(gradient["segments"], 3, "{gradient}");
}

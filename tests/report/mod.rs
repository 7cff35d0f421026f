//! `spreport`: figures against those of all points, one by one.

mod accuracy;
mod failures;
mod points;

use serde_json::Value;

use crate::programs::{Folder, outcome, run};

/// The figures of a report, without a page.
fn report(arguments: &[&str], input: &[u8]) -> Value {
    let output = run("spreport", &[&["-q", "--json", "-"], arguments].concat(), input);
    assert!(output.status.success(), "{arguments:?}: {:?}", outcome(&output));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

/// A number of a report; `a.b` is the number b of the object a.
fn number(report: &Value, key: &str) -> f64 {
    let value = key.split('.').fold(report, |object, key| &object[key]);
    value.as_f64().unwrap_or_else(|| panic!("{key} is {value}"))
}

fn assert_near(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-9 * expected.abs().max(1.0), "{found}, expected {expected}");
}

/// Writes the mesh of points as text.
fn mesh(folder: &Folder, points: &str) -> String {
    let stream = run("spfinalize", &["-q", "-"], points.as_bytes());
    let mesh = run("spdelaunay2d", &["-q"], &stream.stdout);
    assert!(mesh.status.success(), "{:?}", outcome(&mesh));
    folder.write("mesh.spm", mesh.stdout)
}

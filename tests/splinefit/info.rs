//! The output of `splinefit info`, and control meshes.

use serde_json::Value;

use super::{bowl, knots, output, plane, points, rows};
use crate::programs::{Folder, outcome, run};

fn info(arguments: &[&str], input: &[u8]) -> Value {
    serde_json::from_slice(&output(&[&["info", "--json"], arguments].concat(), input)).unwrap()
}

/// A grid over a square; inner knots are moved off it by up to `moved` along each axis.
fn grid(moved: f64) -> String {
    let by = |i: i32, j: i32, seed: i32| moved * f64::from((i * 7 + j * 13 + seed * 5) % 11 - 5) / 5.0;
    let at = |i: i32, j: i32| match (1..5).contains(&i) && (1..5).contains(&j) {
        true => format!("{} {}\n", f64::from(i) + by(i, j, 1), f64::from(j) + by(i, j, 2)),
        false => format!("{i} {j}\n"),
    };
    (0..36).map(|k| at(k % 6, k / 6)).collect()
}

#[test]
fn splines_are_described() {
    let folder = Folder::new();
    let (knots, points) =
        (folder.write("knots.txt", knots()), folder.write("points.txt", points(3_000, 2, bowl)));
    let spline = folder.path("spline.spm");
    output(&["fit", "--knots", &knots, "-o", &spline, &points], &[]);
    let far = folder.write("far.txt", "50 40 2.5\n500 500 0\n");
    let said = info(&[&spline, &points, &far, "-q"], &[]);
    assert_eq!((&said["degree"], &said["places"]), (&2.into(), &36.into()));
    assert_eq!(said["knots"], 36 + 20);
    assert_eq!(said["domain"], serde_json::json!([0.0, 0.0, 100.0, 80.0]));
    assert_eq!((&said["residuals"]["count"], &said["residuals"]["outside"]), (&3_001.into(), &1.into()));
    // All points but one are on the spline.
    let off = (2.5 - bowl(50.0, 40.0)).abs();
    assert!((said["residuals"]["max"].as_f64().unwrap() - off).abs() < 1e-8);
    assert_eq!(said["residuals"]["worst"], serde_json::json!([50.0, 40.0]));
    assert!(said["residuals"]["99"].as_f64().unwrap() < 1e-8);
    let rms = said["residuals"]["rms"].as_f64().unwrap();
    assert!((rms * 3_001f64.sqrt() / off - 1.0).abs() < 1e-6);
    let text = String::from_utf8(output(&["info", &spline, &points], &[])).unwrap();
    for part in [
        "degree       2",
        "knots        56 at 36 places",
        "condition",
        "smoothness   C1",
        "residuals    of 3000",
    ] {
        assert!(text.contains(part), "{text}");
    }
}

#[test]
fn conditions_are_those_of_the_thesis() {
    // SPLINES.md: 6 by 6 knots, pulled apart, Greville sites: 96 functions and a condition near 6.7.
    let grid = grid(0.0);
    let set = run("configgen", &["--boundary", "pulled-apart"], grid.as_bytes()).stdout;
    let said = info(&["-"], &set);
    assert_eq!(said["functions"], 96);
    let condition = said["condition"]["value"].as_f64().unwrap();
    assert!((6.4..7.0).contains(&condition), "{condition}");
    // A small basis has the exact condition, in the 2-norm; estimates are in the 1-norm.
    assert_eq!(said["condition"]["norm"], 2);
}

#[test]
fn folds_are_where_knots_are_on_lines() {
    let of = |knots: &str| {
        let set = run("configgen", &["--boundary", "pulled-apart"], knots.as_bytes()).stdout;
        let said = info(&["-"], &set)["smoothness"].clone();
        assert_eq!(said["order"], 1);
        (said["candidates"].as_array().unwrap().clone(), said["folds"].as_array().unwrap().clone())
    };
    // On a grid, single functions have folds along its lines.
    let (candidates, folds) = of(&grid(0.0));
    assert!(folds.len() > 20 && folds.len() <= candidates.len(), "{}", folds.len());
    // Off the grid, folds remain only at the border.
    let (_, folds) = of(&grid(0.2));
    for fold in &folds {
        let ends = fold["ends"].as_array().unwrap();
        let is_border = |end: &Value| (0..2).any(|axis| [0.0, 5.0].contains(&end[axis].as_f64().unwrap()));
        assert!(ends.iter().any(is_border), "{fold}");
    }
}

#[test]
fn control_meshes_of_planes_are_planes() {
    let folder = Folder::new();
    let (knots, points) =
        (folder.write("knots.txt", knots()), folder.write("points.txt", points(3_000, 2, plane)));
    let spline = output(&["fit", "--knots", &knots, &points], &[]);
    let mesh = output(&["mesh"], &spline);
    let audit = run("spinfo", &["--audit", "-"], &mesh);
    assert!(audit.status.success(), "{:?}", outcome(&audit));
    let twin = String::from_utf8(run("spconvert", &["--to", "text"], &mesh).stdout).unwrap();
    let vertices: String =
        twin.lines().filter_map(|line| line.strip_prefix("v ")).map(|line| format!("{line}\n")).collect();
    let vertices = rows(vertices.as_bytes());
    assert!(vertices.len() > 90);
    assert!(vertices.iter().all(|row| (row[2] - plane(row[0], row[1])).abs() < 1e-7));
}

#[test]
fn control_meshes_are_drawn() {
    let folder = Folder::new();
    let spline = output(&["fit"], points(3_000, 2, plane).as_bytes());
    let path = folder.path("control.svg");
    output(&["mesh", "-", "-o", &path], &spline);
    let picture = std::fs::read_to_string(&path).unwrap();
    let triangles = output(&["mesh"], &spline);
    let twin = String::from_utf8(run("spconvert", &["--to", "text"], &triangles).stdout).unwrap();
    let expected = twin.lines().filter(|line| line.starts_with("f ")).count();
    assert!(expected > 50);
    assert_eq!(picture.matches("<path color=").count(), expected);
    assert!(picture.contains("Control mesh of stdin"));
    assert!(picture.starts_with("<svg ") && picture.ends_with("</svg>\n") && !picture.contains("NaN"));
    // The least and the greatest elevation have the colours at the ends of the ramp.
    assert!(picture.contains("#011959") && picture.contains("#faccfa"));
    assert_eq!(output(&["mesh", "-", "--svg"], &spline), picture.as_bytes());
}

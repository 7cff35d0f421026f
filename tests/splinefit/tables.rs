//! Tables: a line of `#` and names, then numbers with blanks between them.

use std::fs;

use super::{bowl, output, points};
use crate::programs::{Folder, assert_outcome, outcome, run};

/// What `numpy.genfromtxt(names=True)` takes: the names of the first line, and as many numbers in each line.
fn parse(table: &[u8]) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = std::str::from_utf8(table).unwrap();
    let (title, rest) = text.split_once('\n').unwrap();
    let names: Vec<String> = title.strip_prefix("# ").unwrap().split(' ').map(str::to_string).collect();
    // `numpy.loadtxt` skips all lines that start with #, and there is one.
    assert!(!rest.contains('#'));
    let row = |line: &str| {
        let numbers: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
        assert_eq!(numbers.len(), names.len(), "{line}");
        numbers
    };
    let rows = rest.lines().map(row).collect();
    (names, rows)
}

#[test]
fn all_tables_have_names_in_a_comment() {
    let folder = Folder::new();
    let text = points(800, 1, |x, y| bowl(x, y) + if x > 97.0 { 50.0 } else { 0.0 });
    let points = folder.write("points.txt", text);
    let [spline, residuals, rejected] =
        ["s.spm", "residuals.txt", "rejected.txt"].map(|name| folder.path(name));
    let arguments = ["fit", "--robust", "tukey", "-o", &spline, &points];
    output(&[&arguments[..], &["--residuals", &residuals, "--rejected", &rejected]].concat(), &[]);
    for list in [&residuals, &rejected] {
        let (names, rows) = parse(&fs::read(list).unwrap());
        assert_eq!(names, ["x", "y", "z", "residual"]);
        assert!(rows.len() > 3, "{list}");
    }
    let sites = folder.write("sites.txt", "50 40\n1000 1000\n");
    for (kind, expected) in [
        ("value", &["value"][..]),
        ("slope", &["slope"]),
        ("aspect", &["aspect"]),
        ("profile-curvature", &["profile_curvature"]),
        ("tangential-curvature", &["tangential_curvature"]),
        ("gradient", &["dx", "dy"]),
        ("hessian", &["dxx", "dxy", "dyy"]),
    ] {
        for of in [&["--at", &sites[..]][..], &["--columns", "4"]] {
            let (names, rows) = parse(&output(&[&["eval", &spline, "--kind", kind], of].concat(), &[]));
            assert_eq!(names[..2], ["x", "y"]);
            assert_eq!(names[2..], *expected);
            assert!(!rows.is_empty());
        }
    }
}

#[test]
fn tables_are_points_again() {
    let folder = Folder::new();
    let points = folder.write("points.txt", points(800, 1, bowl));
    let spline = output(&["fit", &points], &[]);
    let table = output(&["eval", "-", "--columns", "20"], &spline);
    let again = run("splinefit", &["fit", "-"], &table);
    assert!(again.status.success(), "{:?}", outcome(&again));
}

#[test]
fn points_that_are_not_finite_are_dropped_on_request() {
    let folder = Folder::new();
    let good = points(800, 1, bowl);
    let text = format!("1 1 nan\n{good}inf 4 2\n");
    let path = folder.write("points.txt", &text);
    let advice = "(--skip-invalid drops and counts such points)";
    assert_outcome("splinefit", &["fit", &path], &[], 3, advice);
    let made = run("splinefit", &["fit", "--skip-invalid", &path], &[]);
    let (code, message) = outcome(&made);
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("2 points with a coordinate that is not finite dropped"), "{message}");
    assert!(made.stdout == output(&["fit"], good.as_bytes()));
    // Weights are those of all points that are kept.
    let weights = folder.write("weights.txt", "1\n".repeat(802));
    let arguments = ["fit", "--skip-invalid", "--weights", &weights, &path];
    assert_outcome("splinefit", &arguments, &[], 2, "802 weights for 800 points");
    assert_outcome("splinefit", &arguments, &[], 2, "not finite dropped");
    // Sites have their lines in the output: none is dropped.
    let spline = folder.write("spline.spm", &made.stdout);
    assert_outcome("splinefit", &["eval", &spline, "--at", &path], &[], 3, "leave it out");
    // Messages of programs without the flag name the program that has it.
    let of_knots = run("configgen", &[&path], &[]);
    assert!(outcome(&of_knots).1.contains("spfinalize --skip-invalid drops"), "{:?}", outcome(&of_knots));
}

//! Observations from files.

use super::bases::{ONE, deviation, pulled_apart};
use super::fits::least_squares;
use spmesh_formats::source::{Input, SourceOptions};
use spmesh_splines::fitting::NormalEquations;
use spmesh_splines::splinefit::Elevations;
use std::fmt::Write;

fn f([x, y]: [f64; 2]) -> f64 {
    50.0 + 3.0 * x - 2.0 * y + x * y
}

fn opened(text: &str, columns: u8) -> (tempfile::TempDir, Input) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("points.txt");
    std::fs::write(&path, text).expect("a file");
    let options = SourceOptions { dims: columns, ..SourceOptions::default() };
    let input = Input::open(&[path], &options).expect("points");
    (folder, input)
}

#[test]
fn points_of_files_are_read_as_often_as_needed() {
    let mut text = String::new();
    for i in 0..400 {
        let x = [f64::from(i % 20) / 19.0, f64::from(i / 20) / 19.0];
        writeln!(text, "{} {} {}", x[0], x[1], f(x)).expect("a line");
    }
    let (_folder, input) = opened(&text, 2);
    let observations = Elevations::of(&input).expect("elevations");
    let basis = pulled_apart(&super::bases::grid(3, 0.2));
    let coefficients = least_squares(&basis, &observations, 0.0, ONE).expect("coefficients");
    assert!(deviation(&basis, &coefficients, 21, f) < 1e-9);
    let [first, second] =
        [(); 2].map(|()| NormalEquations::of(&basis, &observations, ONE).expect("equations"));
    assert_eq!(first.count, 400);
    assert_eq!(first, second);
}

#[test]
fn points_without_elevations_are_refused() {
    let (_folder, input) = opened("0 0\n1 0\n0 1\n", 2);
    let said = Elevations::of(&input).expect_err("no elevations").to_string();
    assert!(said.contains("points.txt") && said.contains("no elevation"), "{said}");
}

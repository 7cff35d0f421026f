//! Quadratic splines over grids with clamped corners: functions of knots on a straight border.

use super::bases::{ONE, dense, deviation, scattered};
use spmesh_geometry::configurations::special::functions;
use spmesh_geometry::configurations::{self, Knots, Rule};
use spmesh_splines::bases::Basis;
use spmesh_splines::fitting::{interpolate, least_squares};

/// Functions over a square grid of knots in the unit square, those of knots at one place collected.
fn clamped(side: usize) -> Basis {
    let at = |i: usize| i as f64 / (side - 1) as f64;
    let points = (0..side * side).map(|i| [at(i / side), at(i % side)]).collect();
    let knots = Knots::new(points).and_then(|knots| knots.clamped(1)).expect("a hull");
    let start = configurations::delaunay(&knots).expect("triangles");
    let all = configurations::generate(&knots, start, &Rule::Delaunay, 1).expect("degrees");
    let links = configurations::links(&knots, &all[1]).expect("links");
    Basis::of_functions(&knots, &all[1], &functions(&knots, &links).expect("functions")).expect("a basis")
}

fn quadratic([x, y]: [f64; 2]) -> f64 {
    1.0 - x + 2.0 * y + 3.0 * x * x - x * y - 2.0 * y * y
}

#[test]
fn functions_that_are_zero_are_left_out() {
    // A function of two knots on a side of the square, with a third one between them.
    for side in [3, 7] {
        let basis = clamped(side);
        let places = (0..=120).flat_map(|i| (0..=120).map(move |j| [i, j].map(|k| f64::from(k) / 120.0)));
        let rows = dense(&basis, places);
        for function in 0..basis.len() {
            assert!(rows.iter().any(|row| row[function] > 0.1), "{side}: function {function}");
            assert!(basis.support(function).is_some());
        }
        assert!(rows.iter().all(|row| (row.iter().sum::<f64>() - 1.0).abs() < 1e-14));
    }
}

#[test]
fn clamped_splines_interpolate_and_approximate_without_an_energy() {
    for side in [3, 7] {
        let basis = clamped(side);
        let interpolated = interpolate(&basis, quadratic).expect("a spline");
        assert!(deviation(&basis, &interpolated, 41, quadratic) < 1e-12);
        let all = scattered(4_000, 2, quadratic);
        let fitted = least_squares(&basis, &all, 0.0, ONE).expect("coefficients");
        assert!(deviation(&basis, &fitted, 41, quadratic) < 1e-9);
    }
}

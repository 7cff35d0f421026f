//! Quadratic splines over grids with clamped corners: functions of knots on a straight border.

use super::bases::{ONE, dense, deviation, scattered, value};
use super::fits::least_squares;
use spmesh_configurations::special::functions;
use spmesh_configurations::{self as configurations, Knots, Rule};
use spmesh_splines::bases::Basis;
use spmesh_splines::fitting::{Equations, NormalEquations, Observation, bending, interpolate};

/// Functions over a square grid of knots in the unit square, those of knots at one place collected.
fn clamped(side: usize) -> Basis {
    rotated(side, 0.0)
}

/// The place of a point of the unit square that is rotated around the origin.
fn rotate([x, y]: [f64; 2], degrees: f64) -> [f64; 2] {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    [cosine * x - sine * y, sine * x + cosine * y]
}

/// The same over a rotated grid.
fn rotated(side: usize, degrees: f64) -> Basis {
    let at = |i: usize| i as f64 / (side - 1) as f64;
    let points = (0..side * side).map(|i| rotate([at(i / side), at(i % side)], degrees)).collect();
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

#[test]
fn rotated_grids_have_narrow_functions_that_do_no_harm() {
    for (side, degrees) in [(3, 17.3), (3, 61.1), (7, 17.3), (7, 33.7), (7, 61.1)] {
        let basis = rotated(side, degrees);
        assert!(basis.len() > clamped(side).len(), "{side}, {degrees}: rounding makes functions");
        let all: Vec<_> = scattered(4_000, 2, quadratic)
            .into_iter()
            .map(|one| Observation { point: rotate(one.point, degrees), ..one })
            .collect();
        let normal = NormalEquations::of(&basis, &all, ONE).expect("equations");
        let energy = bending(&basis).expect("an energy");
        let found = Equations::new(&basis, &normal, Some(&energy)).and_then(|all| all.solution(0.0));
        let found = found.expect("coefficients");
        assert!(found.has_converged);
        // On the border, no observation determines the functions that are not zero there only.
        for (i, j) in (0..=60).flat_map(|i| (0..=60).map(move |j| (i, j))) {
            let x = [f64::from(i) / 60.0, f64::from(j) / 60.0];
            let place = rotate(x, degrees);
            if basis.is_in_domain(place) {
                let error = (value(&basis, &found.coefficients, place) - quadratic(x)).abs();
                let is_inside = [i, j].iter().all(|k| (1..60).contains(k));
                let error_max = if is_inside { 1e-6 } else { 0.5 };
                assert!(error < error_max, "{side}, {degrees}: {error} at {x:?}");
            }
        }
        let refused = least_squares(&basis, &all, 0.0, ONE).map_err(|error| error.to_string());
        assert!(refused.is_err_and(|said| said.contains("on one line except for rounding")));
        let refused = interpolate(&basis, |_| 1.0).map_err(|error| error.to_string());
        assert!(refused.is_err_and(|said| said.contains("on one line except for rounding")));
    }
}

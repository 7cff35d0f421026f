//! The membrane energy against known integrals, and against differences of values at many places.

use super::bases::{cubic, grid, pulled_apart, value};
use spmesh_reference::sets::Random;
use spmesh_splines::bases::Basis;
use spmesh_splines::fitting::{interpolate, membrane};

/// The energy of a spline on the unit square: slopes are differences of values, a hundredth of a step apart.
fn by_differences(basis: &Basis, coefficients: &[f64], side: usize) -> f64 {
    let step = 1.0 / side as f64;
    let half = 0.005 * step;
    let at = |x: f64, y: f64| value(basis, coefficients, [x, y]);
    let mut sum = 0.0;
    for (i, j) in (0..side).flat_map(|i| (0..side).map(move |j| (i as f64, j as f64))) {
        let (x, y) = ((i + 0.5) * step, (j + 0.5) * step);
        let slope_x = (at(x + half, y) - at(x - half, y)) / (2.0 * half);
        let slope_y = (at(x, y + half) - at(x, y - half)) / (2.0 * half);
        sum += (slope_x * slope_x + slope_y * slope_y) * step * step;
    }
    sum
}

#[test]
fn energies_of_quadratic_polynomials_are_exact() {
    for basis in [pulled_apart(&grid(5, 0.2)), pulled_apart(&grid(4, 0.0)), cubic(&grid(3, 0.2))] {
        let energy = membrane(&basis).expect("an energy");
        // Integrals over the unit square.
        for (f, expected) in [
            ((|_| 7.0) as fn([f64; 2]) -> f64, 0.0),
            (|[x, y]| 2.0 * x - y + 3.0, 5.0),
            (|[x, _]| x * x, 4.0 / 3.0),
            (|[x, y]| x * y, 2.0 / 3.0),
            (|[x, y]| (x - y) * (x - y), 8.0 / 6.0),
        ] {
            let found = energy.form(&interpolate(&basis, f).expect("a spline"));
            assert!((found - expected).abs() < 1e-9, "{found}, {expected}");
        }
    }
}

#[test]
fn energies_of_splines_are_those_of_differences() {
    let mut random = Random::new(9);
    for (basis, tolerance) in [
        (pulled_apart(&grid(5, 0.2)), 0.05),
        (pulled_apart(&grid(4, 0.0)), 0.05),
        (cubic(&grid(3, 0.2)), 0.05),
    ] {
        let energy = membrane(&basis).expect("an energy");
        for _ in 0..3 {
            let coefficients: Vec<f64> = (0..basis.len()).map(|_| random.unit()).collect();
            let (found, expected) = (energy.form(&coefficients), by_differences(&basis, &coefficients, 200));
            assert!((found / expected - 1.0).abs() < tolerance, "{found}, {expected}");
        }
    }
}

#[test]
fn knots_in_line_but_for_rounding_are_not_stiff() {
    let turned = |[x, y]: [f64; 2]| [0.8 * x - 0.6 * y + 100.0, 0.6 * x + 0.8 * y + 300.0];
    let basis = pulled_apart(&grid(6, 0.0).into_iter().map(turned).collect::<Vec<_>>());
    let energy = membrane(&basis).expect("an energy");
    let greatest = energy.diagonal().fold(0.0, f64::max);
    assert!(greatest < 100.0, "{greatest}");
}

//! Smoothing: between a plane and plain least squares.

use super::bases::{ONE, deviation, grid, pulled_apart, scattered, solve_dense};
use super::fits::least_squares;
use spmesh_splines::fitting::{Equations, NormalEquations, Observation, thin_plate};

fn f([x, y]: [f64; 2]) -> f64 {
    (7.0 * x).sin() * (5.0 * y).cos() + 2.0 * x
}

/// The least-squares plane, from three equations.
fn plane(all: &[Observation]) -> Vec<f64> {
    let row = |one: &Observation| [1.0, one.point[0], one.point[1]];
    let entry = |i: usize, j: usize| all.iter().map(|one| row(one)[i] * row(one)[j]).sum();
    let rows = (0..3).map(|i| (0..3).map(|j| entry(i, j)).collect()).collect();
    solve_dense(rows, (0..3).map(|i| all.iter().map(|one| row(one)[i] * one.value).sum()).collect())
}

#[test]
fn a_great_lambda_leaves_the_plane_of_least_squares() {
    let basis = pulled_apart(&grid(6, 0.2));
    let all = scattered(2_000, 3, f);
    let plane = plane(&all);
    let (normal, energy) =
        (NormalEquations::of(&basis, &all, ONE).expect("equations"), thin_plate(&basis).expect("an energy"));
    let equations = Equations::new(&basis, &normal, Some(&energy)).expect("equations");
    let distance = |lambda: f64| {
        let coefficients = equations.solve(lambda * equations.unit()).expect("coefficients");
        deviation(&basis, &coefficients, 31, |[x, y]| plane[0] + plane[1] * x + plane[2] * y)
    };
    let found = [1e6, 1e7, 1e8, 1e9].map(distance);
    // For large lambda, the distance is proportional to 1 / lambda.
    assert!(found.windows(2).all(|pair| pair[1] < 0.4 * pair[0]), "{found:?}");
    assert!(found[3] < 5e-3 && found[3] < 0.12 * found[2], "{found:?}");
}

#[test]
fn more_smoothing_means_less_energy_and_greater_residuals() {
    let basis = pulled_apart(&grid(6, 0.2));
    let all = scattered(1_000, 4, f);
    let (normal, energy) =
        (NormalEquations::of(&basis, &all, ONE).expect("equations"), thin_plate(&basis).expect("an energy"));
    let equations = Equations::new(&basis, &normal, Some(&energy)).expect("equations");
    let mut before = (f64::INFINITY, 0.0);
    for exponent in -8..4 {
        let coefficients = equations.solve(equations.unit() * 10f64.powi(exponent)).expect("coefficients");
        let (bending, square) = (energy.form(&coefficients), normal.residual_square(&coefficients));
        assert!(bending < before.0 * (1.0 + 1e-9) && square > before.1 * (1.0 - 1e-9));
        before = (bending, square);
    }
}

#[test]
fn gaps_are_filled_smoothly() {
    let basis = pulled_apart(&grid(10, 0.2));
    let f = |[x, y]: [f64; 2]| x * x + y;
    let mut all = scattered(4_000, 5, f);
    all.retain(|one| !one.point.iter().all(|&c| (0.3..0.7).contains(&c)));
    assert!(least_squares(&basis, &all, 0.0, ONE).is_err());
    let coefficients = least_squares(&basis, &all, 1e-6, ONE).expect("coefficients");
    let error = deviation(&basis, &coefficients, 41, f);
    assert!(error < 0.02, "{error}");
}

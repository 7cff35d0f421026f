//! Functions that observations leave undetermined take the least energy; all others are least squares.

use super::bases::{ONE, dense, deviation, grid, pulled_apart, scattered, solve_dense};
use super::fits::robust;
use spmesh_splines::bases::Basis;
use spmesh_splines::fitting::{Equations, Loss, NormalEquations, Observation, bending};

fn f([x, y]: [f64; 2]) -> f64 {
    (7.0 * x).sin() * (5.0 * y).cos() + 2.0 * x
}

/// Observations everywhere but in a square hole.
fn around_a_hole(f: impl Fn([f64; 2]) -> f64) -> Vec<Observation> {
    let mut all = scattered(4_000, 5, f);
    all.retain(|one| !one.point.iter().all(|&c| (0.3..0.7).contains(&c)));
    all
}

fn fit(basis: &Basis, all: &[Observation]) -> Vec<f64> {
    let normal = NormalEquations::of(basis, all, ONE).expect("equations");
    let energy = bending(basis).expect("an energy");
    Equations::new(basis, &normal, Some(&energy)).expect("equations").solve(0.0).expect("coefficients")
}

/// The functions that are not zero at some observation, and the others.
fn seen(rows: &[Vec<f64>]) -> (Vec<usize>, Vec<usize>) {
    (0..rows[0].len()).partition(|&function| rows.iter().any(|row| row[function] != 0.0))
}

#[test]
fn what_observations_determine_is_least_squares() {
    let basis = pulled_apart(&grid(10, 0.2));
    let all = around_a_hole(f);
    let found = fit(&basis, &all);
    let rows = dense(&basis, all.iter().map(|one| one.point));
    let (seen, unseen) = seen(&rows);
    assert!(unseen.len() > 10, "{}", unseen.len());
    // The residuals are perpendicular to all functions, so that no other coefficients have smaller ones.
    let residual = |(row, one): (&Vec<f64>, &Observation)| {
        one.value - row.iter().zip(&found).map(|(value, c)| value * c).sum::<f64>()
    };
    let residuals: Vec<f64> = rows.iter().zip(&all).map(residual).collect();
    let length = residuals.iter().map(|residual| residual * residual).sum::<f64>().sqrt();
    for function in seen {
        let column = || rows.iter().map(|row| row[function]);
        let size = column().map(|value| value * value).sum::<f64>().sqrt();
        let product: f64 = column().zip(&residuals).map(|(value, residual)| value * residual).sum();
        assert!(product.abs() < 1e-7 * size * length, "{function}: {product}");
    }
    // Without observations, the energy has no slope, so that no other coefficients have less of it.
    let energy = bending(&basis).expect("an energy");
    let slope = energy.times(&found);
    for function in unseen {
        let most = energy.at(function, function) * found.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
        assert!(slope[function].abs() < 1e-6 * most, "{function}: {} of {most}", slope[function]);
    }
}

#[test]
fn determined_splines_are_those_without_an_energy() {
    let basis = pulled_apart(&grid(6, 0.2));
    let all = scattered(2_000, 3, f);
    let rows = dense(&basis, all.iter().map(|one| one.point));
    let entry = |i: usize, j: usize| rows.iter().map(|row| row[i] * row[j]).sum();
    let matrix = (0..basis.len()).map(|i| (0..basis.len()).map(|j| entry(i, j)).collect()).collect();
    let right = (0..basis.len()).map(|i| rows.iter().zip(&all).map(|(row, one)| row[i] * one.value).sum());
    let expected = solve_dense(matrix, right.collect());
    for (found, expected) in fit(&basis, &all).iter().zip(expected) {
        assert!((found - expected).abs() < 1e-8, "{found}, {expected}");
    }
}

#[test]
fn planes_are_continued() {
    let plane = |[x, y]: [f64; 2]| 3.0 - x + 2.0 * y;
    let basis = pulled_apart(&grid(10, 0.2));
    let mut all = scattered(3_000, 5, plane);
    all.retain(|one| one.point[0] < 0.6);
    let error = deviation(&basis, &fit(&basis, &all), 31, plane);
    assert!(error < 1e-9, "{error}");
}

#[test]
fn robust_fits_continue_over_gaps() {
    let basis = pulled_apart(&grid(10, 0.2));
    let mut all = around_a_hole(|[x, y]| x - y);
    all.iter_mut().step_by(20).for_each(|one| one.value += 9.0);
    let energy = bending(&basis).expect("an energy");
    let found = robust(&basis, &all, Loss::Tukey, Some(&energy), 0.0, ONE).expect("a fit");
    assert!(deviation(&basis, &found.coefficients, 31, |[x, y]| x - y) < 1e-6);
}

#[test]
fn constants_at_a_few_places_are_constants_everywhere() {
    let basis = pulled_apart(&grid(5, 0.2));
    let places = [[0.05, 0.68], [0.37, 0.59], [0.67, 0.67], [0.6, 0.2], [0.61, 0.21]];
    for count in 3..=places.len() {
        let all: Vec<_> = places[..count].iter().map(|&place| Observation::new(place, 7.25)).collect();
        let error = deviation(&basis, &fit(&basis, &all), 31, |_| 7.25);
        assert!(error < 1e-9, "{count}: {error}");
    }
}

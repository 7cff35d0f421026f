//! Normal equations against dense ones.

use super::bases::{ONE, dense, deviation, grid, pulled_apart, scattered, solve_dense};
use super::fits::{least_squares, summarise};
use spmesh_splines::bases::Basis;
use spmesh_splines::fitting::{Equations, NormalEquations, Observation, for_each_residual};
use std::num::NonZeroUsize;

fn weighted(count: usize) -> Vec<Observation> {
    let mut all = scattered(count, 5, |[x, y]| (4.0 * x).sin() + y * y);
    all.iter_mut().enumerate().for_each(|(i, one)| one.weight = 0.5 + (i % 7) as f64);
    all
}

/// A'WA, A'Wz and z'Wz, summed up entry by entry.
fn by_hand(basis: &Basis, all: &[Observation]) -> (Vec<Vec<f64>>, Vec<f64>, f64) {
    let rows = dense(basis, all.iter().map(|one| one.point));
    let count = basis.len();
    let entry =
        |i: usize, j: usize| rows.iter().zip(all).map(|(row, one)| one.weight * row[i] * row[j]).sum();
    let right = |i: usize| rows.iter().zip(all).map(|(row, one)| one.weight * row[i] * one.value).sum();
    (
        (0..count).map(|i| (0..count).map(|j| entry(i, j)).collect()).collect(),
        (0..count).map(right).collect(),
        all.iter().map(|one| one.weight * one.value * one.value).sum(),
    )
}

#[test]
fn sums_are_those_of_dense_matrices() {
    let basis = pulled_apart(&grid(3, 0.2));
    let all = weighted(700);
    let (matrix, right, square) = by_hand(&basis, &all);
    let normal = NormalEquations::of(&basis, &all, ONE).expect("equations");
    for i in 0..basis.len() {
        for (j, expected) in matrix[i].iter().enumerate() {
            assert!((normal.matrix.at(i, j) - expected).abs() < 1e-11, "{i} {j}");
        }
        assert!((normal.right[i] - right[i]).abs() < 1e-11);
    }
    assert!((normal.square / square - 1.0).abs() < 1e-13);
    assert_eq!((normal.count, normal.outside), (700, 0));
    let expected = solve_dense(matrix, right);
    let found = Equations::new(&basis, &normal, None).expect("equations").solve(0.0).expect("coefficients");
    let error = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(error < 1e-9, "{error}");
    let mut by_residuals = 0.0;
    for_each_residual(&basis, &found, &all, ONE, |one| {
        by_residuals += one.weight * one.residual * one.residual
    })
    .expect("residuals");
    assert!((normal.residual_square(&found) - by_residuals).abs() < 1e-12 * square);
}

#[test]
fn results_do_not_depend_on_threads() {
    let basis = pulled_apart(&grid(6, 0.2));
    let all = weighted(150_000);
    let of = |threads| {
        NormalEquations::of(&basis, &all, NonZeroUsize::new(threads).expect("threads")).expect("equations")
    };
    let one = of(1);
    for threads in [2, 3, 5] {
        let more = of(threads);
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<u64>>();
        assert_eq!(bits(&one.right), bits(&more.right), "{threads} threads");
        assert_eq!(one, more);
        assert_eq!(one.square.to_bits(), more.square.to_bits());
    }
}

#[test]
fn weights_are_numbers_of_equal_observations() {
    let basis = pulled_apart(&grid(3, 0.2));
    let mut few = scattered(300, 8, |[x, y]| x + (9.0 * y).cos());
    few.iter_mut().enumerate().for_each(|(i, one)| one.weight = (i % 4) as f64);
    let times = |one: &Observation| vec![Observation { weight: 1.0, ..*one }; one.weight as usize];
    let many: Vec<Observation> = few.iter().flat_map(times).collect();
    let [few, many] = [&few, &many].map(|all| least_squares(&basis, all, 0.0, ONE).expect("coefficients"));
    let error = few.iter().zip(&many).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(error < 1e-11, "{error}");
}

#[test]
fn polynomials_of_degree_2_are_reproduced() {
    let basis = pulled_apart(&grid(8, 0.2));
    let f = |[x, y]: [f64; 2]| 3.0 * x * x - x * y + 0.25 * y * y - 2.0 * x + 11.0;
    let all = scattered(6_000, 2, f);
    let coefficients = least_squares(&basis, &all, 0.0, ONE).expect("coefficients");
    let error = deviation(&basis, &coefficients, 61, f);
    assert!(error < 1e-10, "{error}");
    let summary = summarise(&basis, &coefficients, &all, ONE).expect("residuals");
    assert_eq!((summary.count, summary.outside), (6_000, 0));
    let worst = summary.worst.expect("residuals").residual.abs();
    assert!(worst < 1e-10 && summary.root_mean_square <= worst && summary.mean.abs() <= worst);
}

#[test]
fn residuals_are_orthogonal_to_functions() {
    let basis = pulled_apart(&grid(4, 0.2));
    let all = weighted(3_000);
    let coefficients = least_squares(&basis, &all, 0.0, ONE).expect("coefficients");
    let rows = dense(&basis, all.iter().map(|one| one.point));
    let mut products = vec![0.0; basis.len()];
    for_each_residual(&basis, &coefficients, &all, ONE, |one| {
        let row = &rows[one.index as usize];
        products.iter_mut().zip(row).for_each(|(sum, value)| *sum += one.weight * one.residual * value);
    })
    .expect("residuals");
    assert!(products.iter().all(|product| product.abs() < 1e-9), "{products:?}");
}

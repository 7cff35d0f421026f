//! Smoothing by restricted maximum likelihood, checked in the space of observations.

use super::bases::{ONE, dense, grid, pulled_apart, scattered, solve_dense};
use spmesh_reference::sets::Random;
use spmesh_splines::fitting::{self, Equations, NormalEquations, Observation, thin_plate};

fn noisy(count: usize) -> Vec<Observation> {
    let mut random = Random::new(5);
    let mut all = scattered(count, 8, |[x, y]| (5.0 * x).sin() + y);
    all.iter_mut().for_each(|one| {
        one.value += 0.2 * (random.unit() - 0.5);
        one.weight = 0.5 + random.unit();
    });
    all
}

/// Solves dense equations for several right sides, given as rows.
fn solved(rows: &[Vec<f64>], rights: &[Vec<f64>]) -> Vec<Vec<f64>> {
    rights.iter().map(|right| solve_dense(rows.to_vec(), right.clone())).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The logarithm of the determinant of a positive definite matrix, by elimination.
fn log_determinant(mut rows: Vec<Vec<f64>>) -> f64 {
    let mut sum = 0.0;
    for i in 0..rows.len() {
        let own = rows[i].clone();
        sum += own[i].ln();
        for row in &mut rows[i + 1..] {
            let factor = row[i] / own[i];
            row.iter_mut().zip(&own).for_each(|(entry, own)| *entry -= factor * own);
        }
    }
    sum
}

/// Twice the negative logarithm of the restricted likelihood, except for a constant: of observations with the
/// covariance V = W^-1 + A E^- A' / lambda and unknown linear functions T. E^- = (E + XX')^-1 is a
/// generalised inverse, where X has the coefficients of linear functions; the parts of XX' are linear
/// functions, too.
fn in_space_of_observations(
    all: &[Observation],
    rows: &[Vec<f64>],
    energy: &[Vec<f64>],
    linear: &[Vec<f64>; 3],
    lambda: f64,
) -> f64 {
    let whole: Vec<Vec<f64>> = (0..energy.len())
        .map(|i| {
            (0..energy.len())
                .map(|j| energy[i][j] + linear.iter().map(|x| x[i] * x[j]).sum::<f64>())
                .collect()
        })
        .collect();
    let inner = solved(&whole, rows);
    let covariance: Vec<Vec<f64>> = (0..all.len())
        .map(|i| {
            let own = |j: usize| if i == j { 1.0 / all[i].weight } else { 0.0 };
            (0..all.len()).map(|j| own(j) + dot(&rows[i], &inner[j]) / lambda).collect()
        })
        .collect();
    let fixed: Vec<Vec<f64>> = linear.iter().map(|x| rows.iter().map(|row| dot(row, x)).collect()).collect();
    let values: Vec<f64> = all.iter().map(|one| one.value).collect();
    let of_fixed = solved(&covariance, &fixed);
    let of_values = solve_dense(covariance.clone(), values.clone());
    let products: Vec<Vec<f64>> =
        fixed.iter().map(|a| of_fixed.iter().map(|b| dot(a, b)).collect()).collect();
    let mixed: Vec<f64> = fixed.iter().map(|a| dot(a, &of_values)).collect();
    let slopes = solve_dense(products.clone(), mixed.clone());
    let rest = dot(&values, &of_values) - dot(&mixed, &slopes);
    log_determinant(covariance) + log_determinant(products) + (all.len() as f64 - 3.0) * rest.ln()
}

#[test]
fn scores_are_likelihoods_of_observations() {
    let basis = pulled_apart(&grid(3, 0.2));
    let all = noisy(70);
    let (normal, energy) =
        (NormalEquations::of(&basis, &all, ONE).expect("equations"), thin_plate(&basis).expect("an energy"));
    let equations = Equations::new(&basis, &normal, Some(&energy)).expect("equations");
    let choice = fitting::restricted_likelihood(&equations).expect("a choice");
    let rows = dense(&basis, all.iter().map(|one| one.point));
    let count = basis.len();
    let energy: Vec<Vec<f64>> = (0..count).map(|i| (0..count).map(|j| energy.at(i, j)).collect()).collect();
    let linear = [|_| 1.0, |[x, _]: [f64; 2]| x, |[_, y]: [f64; 2]| y]
        .map(|f: fn([f64; 2]) -> f64| (0..count).map(|function| f(basis.greville(function))).collect());
    let known = |lambda| in_space_of_observations(&all, &rows, &energy, &linear, lambda);
    let (first, at_first) = (choice.trials[0], known(choice.trials[0].lambda));
    assert!(choice.trials.len() > 3, "{choice:?}");
    for trial in &choice.trials {
        let found = (all.len() as f64 - 3.0) * (trial.score / first.score).ln();
        let expected = known(trial.lambda) - at_first;
        assert!((found - expected).abs() < 1e-6, "{trial:?}: {found}, {expected}");
    }
    // No other lambda is much likelier.
    let best = known(choice.best.lambda);
    let others = (-30..60).map(|tenth| equations.default_lambda() * 10f64.powf(f64::from(tenth) / 10.0));
    let least = others.map(known).fold(f64::INFINITY, f64::min);
    assert!(best < least + 0.05, "{best}, {least}: {choice:?}");
}

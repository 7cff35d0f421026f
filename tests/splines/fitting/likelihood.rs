//! Smoothing by restricted maximum likelihood, checked in the space of observations.

use super::bases::{ONE, dense, grid, pulled_apart, scattered, solve_dense};
use spmesh_reference::sets::Random;
use spmesh_splines::bases::Basis;
use spmesh_splines::fitting::{self, Equations, NormalEquations, Observation, Symmetric, thin_plate};

pub(super) fn noisy(count: usize) -> Vec<Observation> {
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

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
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

/// An energy less the part that linear functions have: E - EX S^-1 X'E, where the columns of X are the slopes
/// and S = X'EX. Linear functions have none then.
pub(super) fn without_linear_part(energy: &mut [Vec<f64>], slopes: [&Vec<f64>; 2]) {
    let products = slopes.map(|x| energy.iter().map(|row| dot(row, x)).collect::<Vec<f64>>());
    let [a, b, d] = [[0, 0], [0, 1], [1, 1]].map(|[i, j]| dot(slopes[i], &products[j]));
    let determinant = a * d - b * b;
    if a < 1e-9 {
        return;
    }
    for (i, row) in energy.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            let [[p, q], [r, s]] = [i, j].map(|at| [products[0][at], products[1][at]]);
            *entry -= (d * p * r - b * (p * s + q * r) + a * q * s) / determinant;
        }
    }
}

/// As [`in_space_of_observations`].
fn known_score(basis: &Basis, all: &[Observation], energy: &Symmetric, lambda: f64) -> f64 {
    let rows = dense(basis, all.iter().map(|one| one.point));
    let count = basis.len();
    let mut energy: Vec<Vec<f64>> =
        (0..count).map(|i| (0..count).map(|j| energy.at(i, j)).collect()).collect();
    let linear: [Vec<f64>; 3] = [|_| 1.0, |[x, _]: [f64; 2]| x, |[_, y]: [f64; 2]| y]
        .map(|f: fn([f64; 2]) -> f64| (0..count).map(|function| f(basis.greville(function))).collect());
    without_linear_part(&mut energy, [&linear[1], &linear[2]]);
    in_space_of_observations(all, &rows, &energy, &linear, lambda)
}

#[test]
fn scores_are_likelihoods_of_observations() {
    let basis = pulled_apart(&grid(3, 0.2));
    let all = noisy(70);
    let (normal, energy) =
        (NormalEquations::of(&basis, &all, ONE).expect("equations"), thin_plate(&basis).expect("an energy"));
    let equations = Equations::new(&basis, &normal, Some(&energy)).expect("equations");
    let choice = fitting::restricted_likelihood(&equations, None).expect("a choice");
    let known = |lambda| known_score(&basis, &all, &energy, lambda);
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

#[test]
fn tensions_are_compared_by_likelihoods_of_observations() {
    // Steps are likelier for membranes, and waves for plates.
    let basis = pulled_apart(&grid(4, 0.2));
    let steps = scattered(150, 8, |[x, y]| f64::from(u8::from(x > 0.4)) + f64::from(u8::from(x + y > 1.2)));
    let waves = scattered(150, 8, |[x, y]| (3.0 * x).sin() + y * y);
    for (all, is_tense) in [(steps, true), (waves, false)] {
        let normal = NormalEquations::of(&basis, &all, ONE).expect("equations");
        let bending = fitting::bending(&basis).expect("an energy");
        let tried = [0.0, 1.0, 4.0].map(|tension| {
            let found = fitting::choose_tension(&basis, &normal, bending.clone(), &[tension]);
            let found = found.expect("a choice");
            known_score(&basis, &all, &found.energy, found.choice.best.lambda)
        });
        for tensions in [[0.0, 1.0], [0.0, 4.0], [1.0, 4.0], [4.0, 1.0], [1.0, 0.0]] {
            let place = |tension: f64| [0.0, 1.0, 4.0].iter().position(|&one| one == tension).unwrap();
            let [first, second] = tensions.map(|tension| tried[place(tension)]);
            let found = fitting::choose_tension(&basis, &normal, bending.clone(), &tensions);
            let found = found.expect("a choice").tension;
            assert_eq!(found, if second < first { tensions[1] } else { tensions[0] }, "{tried:?}");
        }
        assert_eq!(tried[1] < tried[0], is_tense, "{tried:?}");
    }
}

#[test]
fn scores_in_tension_are_likelihoods_of_observations() {
    let basis = pulled_apart(&grid(3, 0.2));
    let all = noisy(70);
    let normal = NormalEquations::of(&basis, &all, ONE).expect("equations");
    let bending = fitting::bending(&basis).expect("an energy");
    let energy = fitting::with_tension(&basis, &normal, bending, 2.0).expect("an energy");
    let equations = Equations::new(&basis, &normal, Some(&energy)).expect("equations").in_tension();
    let choice = fitting::restricted_likelihood(&equations, None).expect("a choice");
    let known = |lambda| known_score(&basis, &all, &energy, lambda);
    let (first, at_first) = (choice.trials[0], known(choice.trials[0].lambda));
    for trial in &choice.trials {
        let found = (all.len() as f64 - 3.0) * (trial.score / first.score).ln();
        let expected = known(trial.lambda) - at_first;
        assert!((found - expected).abs() < 1e-6, "{trial:?}: {found}, {expected}");
    }
}

#[test]
fn splines_in_tension_are_those_of_dense_equations() {
    // A plane in addition to the values adds itself to the spline.
    let basis = pulled_apart(&grid(3, 0.2));
    let mut all = noisy(70);
    let solved = |all: &[Observation]| {
        let normal = NormalEquations::of(&basis, all, ONE).expect("equations");
        let bending = fitting::bending(&basis).expect("an energy");
        let energy = fitting::with_tension(&basis, &normal, bending, 3.0).expect("an energy");
        let equations = Equations::new(&basis, &normal, Some(&energy)).expect("equations").in_tension();
        (equations.solve(0.5).expect("a spline"), normal, energy)
    };
    let (before, normal, energy) = solved(&all);
    // The least over all planes x of the residuals and the energy of the spline less x: its unknowns are
    // coefficients and two slopes.
    let count = basis.len();
    let slopes = [0, 1].map(|axis| (0..count).map(|at| basis.greville(at)[axis]).collect::<Vec<f64>>());
    let products = slopes.each_ref().map(|slope| energy.times(slope));
    let mut rows: Vec<Vec<f64>> = (0..count)
        .map(|i| {
            let own = (0..count).map(|j| normal.matrix.at(i, j) + 0.5 * energy.at(i, j));
            own.chain(products.iter().map(|product| -0.5 * product[i])).collect()
        })
        .collect();
    for (slope, product) in slopes.iter().zip(&products) {
        let of_slopes = products.iter().map(|other| 0.5 * dot(slope, other));
        rows.push(product.iter().map(|entry| -0.5 * entry).chain(of_slopes).collect());
    }
    let known = solve_dense(rows, normal.right.iter().copied().chain([0.0; 2]).collect());
    for (found, expected) in before.iter().zip(&known) {
        assert!((found - expected).abs() < 1e-8, "{found}, {expected}");
    }
    all.iter_mut().for_each(|one| one.value += 40.0 - 70.0 * one.point[0] + 20.0 * one.point[1]);
    let (after, ..) = solved(&all);
    for (function, (before, after)) in before.iter().zip(&after).enumerate() {
        let [x, y] = basis.greville(function);
        assert!((after - before - 40.0 + 70.0 * x - 20.0 * y).abs() < 1e-8, "{function}");
    }
}

#[test]
fn tensions_out_of_range_are_refused() {
    let basis = pulled_apart(&grid(3, 0.2));
    let normal = NormalEquations::of(&basis, &noisy(70), ONE).expect("equations");
    let bending = fitting::bending(&basis).expect("an energy");
    for tensions in [&[][..], &[-1.0], &[f64::NAN], &[f64::INFINITY]] {
        let found = fitting::choose_tension(&basis, &normal, bending.clone(), tensions);
        assert!(found.is_err_and(|error| error.to_string().contains("tension")), "{tensions:?}");
    }
}

//! Choosing the amount of smoothing.

use super::bases::{ONE, dense, grid, pulled_apart, scattered, solve_dense, value};
use super::fits::least_squares;
use spmesh_reference::sets::Random;
use spmesh_splines::fitting::{self, Equations, Folds, NormalEquations, Observation, thin_plate};

/// A function with normally distributed noise of the given size.
fn noisy(count: usize, noise: f64) -> Vec<Observation> {
    let mut random = Random::new(21);
    let mut all = scattered(count, 20, smooth);
    // The sum of twelve uniform numbers in the unit interval has variance one.
    all.iter_mut().for_each(|one| one.value += noise * ((0..12).map(|_| random.unit()).sum::<f64>() - 6.0));
    all
}

fn smooth([x, y]: [f64; 2]) -> f64 {
    (6.0 * x).sin() + (4.0 * y).cos()
}

#[test]
fn degrees_of_freedom_are_the_trace() {
    let all = noisy(900, 0.1);
    for cells in [3, 10] {
        let basis = pulled_apart(&grid(cells, 0.2));
        let (normal, energy) = (
            NormalEquations::of(&basis, &all, ONE).expect("equations"),
            thin_plate(&basis).expect("an energy"),
        );
        let equations = Equations::new(&basis, &normal, Some(&energy)).expect("equations");
        let lambda = 0.01 * equations.unit();
        let rows = dense(&basis, all.iter().map(|one| one.point));
        let count = basis.len();
        let full: Vec<Vec<f64>> = (0..count)
            .map(|i| (0..count).map(|j| normal.matrix.at(i, j) + lambda * energy.at(i, j)).collect())
            .collect();
        let exact: f64 = (0..count)
            .map(|i| {
                let column = (0..count).map(|j| rows.iter().map(|row| row[i] * row[j]).sum()).collect();
                solve_dense(full.clone(), column)[i]
            })
            .sum();
        let found = fitting::degrees_of_freedom(&equations, lambda).expect("a trace");
        assert!((found / exact - 1.0).abs() < 1e-9, "{count} functions: {found}, {exact}");
    }
}

/// The root mean square distance to the function without noise.
fn distance(basis: &spmesh_splines::bases::Basis, coefficients: &[f64]) -> f64 {
    let points = (0..900).map(|i| [(f64::from(i % 30) + 0.5) / 30.0, (f64::from(i / 30) + 0.5) / 30.0]);
    let square: f64 = points.map(|x| (value(basis, coefficients, x) - smooth(x)).powi(2)).sum();
    (square / 900.0).sqrt()
}

#[test]
fn both_ways_choose_nearly_the_best() {
    let basis = pulled_apart(&grid(8, 0.2));
    let all = noisy(1_200, 0.3);
    let (normal, energy) =
        (NormalEquations::of(&basis, &all, ONE).expect("equations"), thin_plate(&basis).expect("an energy"));
    let equations = Equations::new(&basis, &normal, Some(&energy)).expect("equations");
    let at = |lambda: f64| distance(&basis, &equations.solve(lambda).expect("coefficients"));
    let best = (-40..20).map(|tenth| at(equations.unit() * 10f64.powf(f64::from(tenth) / 5.0)));
    let best = best.fold(f64::INFINITY, f64::min);
    let generalised = fitting::generalised_cross_validation(&equations, None).expect("a choice");
    let folds = Folds::of(&basis, &all, 5, 7, ONE).expect("folds").choose(&basis, &energy).expect("a choice");
    for choice in [&generalised, &folds] {
        let found = at(choice.best.lambda);
        assert!(found < 1.3 * best, "{found}, {best}: {choice:?}");
        assert!(choice.trials.windows(2).all(|pair| pair[0].lambda <= pair[1].lambda));
        assert!(choice.trials.iter().all(|trial| trial.score >= choice.best.score));
        // Errors of prediction are hardly larger than the noise.
        assert!((0.08..0.12).contains(&choice.best.score), "{choice:?}");
    }
    let plain = distance(&basis, &least_squares(&basis, &all, 0.0, ONE).expect("coefficients"));
    assert!(best < 0.7 * plain, "{best}, {plain}");
}

#[test]
fn folds_predict_what_they_leave_out() {
    let basis = pulled_apart(&grid(3, 0.2));
    let all = noisy(400, 0.2);
    let energy = thin_plate(&basis).expect("an energy");
    let choice =
        Folds::of(&basis, &all, 2, 3, ONE).expect("folds").choose(&basis, &energy).expect("a choice");
    assert!(choice.best.score > 0.03 && choice.best.score < 0.08, "{choice:?}");
    assert!(Folds::of(&basis, &all, 1, 3, ONE).is_err());
    let few = &all[..2];
    assert!(Folds::of(&basis, few, 300, 3, ONE).is_err());
}

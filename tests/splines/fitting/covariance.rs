//! Variances of splines against dense equations, and the smoothing that follows from coefficients.

use super::bases::{ONE, dense, grid, pulled_apart, solve_dense};
use super::likelihood::{dot, noisy, without_linear_part};
use spmesh_splines::bases::Scratch;
use spmesh_splines::fitting::{self, Covariance, Equations, NormalEquations, recovered};

const LAMBDA: f64 = 0.03;

#[test]
fn variances_are_those_of_dense_equations() {
    let (basis, all) = (pulled_apart(&grid(4, 0.2)), noisy(90));
    let sites = || (0..60).map(|i| [f64::from(i % 10) / 9.0, f64::from(i / 10) / 5.0]);
    let normal = NormalEquations::of(&basis, &all, ONE).expect("equations");
    for tension in [0.0, 2.0] {
        let bending = fitting::bending(&basis).expect("an energy");
        let energy = fitting::with_tension(&basis, &normal, bending, tension).expect("an energy");
        let equations = Equations::new(&basis, &normal, Some(&energy)).expect("equations");
        let equations = if tension > 0.0 { equations.in_tension() } else { equations };
        let covariance = Covariance::of(&equations, LAMBDA).expect("a covariance");
        // The same from the values of all functions at all observations.
        let count = basis.len();
        let mut whole: Vec<Vec<f64>> =
            (0..count).map(|i| (0..count).map(|j| energy.at(i, j)).collect()).collect();
        let slopes = [0, 1].map(|axis| (0..count).map(|at| basis.greville(at)[axis]).collect::<Vec<f64>>());
        without_linear_part(&mut whole, slopes.each_ref());
        whole.iter_mut().flatten().for_each(|entry| *entry *= LAMBDA);
        for (row, one) in dense(&basis, all.iter().map(|one| one.point)).iter().zip(&all) {
            for (i, j) in (0..count).flat_map(|i| (0..count).map(move |j| (i, j))) {
                whole[i][j] += one.weight * row[i] * row[j];
            }
        }
        let mut scratch = Scratch::default();
        for (site, row) in sites().zip(dense(&basis, sites())) {
            let expected = dot(&row, &solve_dense(whole.clone(), row.clone()));
            let found = covariance.variance(basis.at(site, &mut scratch));
            assert!((found / expected - 1.0).abs() < 1e-8, "{tension} at {site:?}: {found}, {expected}");
        }
        // Of derivatives, by differences of values.
        const STEP: f64 = 1e-4;
        for site in sites().filter(|site| site.iter().all(|x| (0.1..0.9).contains(x))) {
            let moved = [-STEP, STEP].map(|by| [site[0] + by, site[1]]);
            let [low, high] = [0, 1].map(|end| dense(&basis, [moved[end]].into_iter()).remove(0));
            let row: Vec<f64> =
                low.iter().zip(&high).map(|(low, high)| (high - low) / (2.0 * STEP)).collect();
            let expected = dot(&row, &solve_dense(whole.clone(), row.clone()));
            let jets = basis.jets_at(site, &mut scratch);
            let along: Vec<(u32, f64)> = jets.iter().map(|(at, jet)| (*at, jet.gradient[0])).collect();
            let found = covariance.variance(&along);
            assert!((found / expected - 1.0).abs() < 1e-3, "{tension} at {site:?}: {found}, {expected}");
        }
    }
}

#[test]
fn smoothing_follows_from_coefficients() {
    let (basis, all) = (pulled_apart(&grid(4, 0.2)), noisy(90));
    let normal = NormalEquations::of(&basis, &all, ONE).expect("equations");
    let bending = fitting::bending(&basis).expect("an energy");
    let membrane = fitting::membrane(&basis).expect("an energy");
    let plain = Equations::new(&basis, &normal, Some(&bending)).expect("equations");
    for of_membrane in [0.0, 0.4] {
        let energy = bending.plus(of_membrane / LAMBDA, &membrane);
        let equations = Equations::new(&basis, &normal, Some(&energy)).expect("equations");
        let equations = if of_membrane > 0.0 { equations.in_tension() } else { equations };
        let mut coefficients = equations.solve(LAMBDA).expect("a spline");
        let found = recovered(&basis, &plain, [&bending, &membrane], &coefficients).expect("a smoothing");
        assert!((found.lambda / LAMBDA - 1.0).abs() < 1e-6, "{found:?}");
        assert!((found.of_membrane - of_membrane).abs() < 1e-6, "{found:?}");
        // Another spline is refused.
        coefficients[7] += 1e-4;
        let error = recovered(&basis, &plain, [&bending, &membrane], &coefficients).expect_err("refused");
        assert!(error.to_string().contains("not a fit to these points"), "{error}");
    }
}

//! Fits that resist gross errors.

use super::bases::{ONE, deviation, grid, pulled_apart, scattered};
use super::fits::{least_squares, robust};
use spmesh_base::error::Result;
use spmesh_reference::sets::Random;
use spmesh_splines::fitting::{
    Loss, Method, NormalEquations, Observation, ObservationReader, Observations, bending, choose_robustly,
    robust_on,
};
use std::cell::Cell;
use std::num::NonZeroUsize;

fn plane([x, y]: [f64; 2]) -> f64 {
    100.0 + 3.0 * x - 2.0 * y
}

/// Observations of the plane; every tenth is far above it.
fn with_outliers(count: usize, noise: f64) -> Vec<Observation> {
    let mut random = Random::new(31);
    let mut all = scattered(count, 30, plane);
    for (i, one) in all.iter_mut().enumerate() {
        one.value += noise * ((0..12).map(|_| random.unit()).sum::<f64>() - 6.0);
        if i % 10 == 3 {
            one.value += 5.0 + 20.0 * random.unit();
        }
    }
    all
}

#[test]
fn a_plane_with_gross_errors_is_given_back() {
    let basis = pulled_apart(&grid(4, 0.2));
    let all = with_outliers(4_000, 0.0);
    let plain = least_squares(&basis, &all, 0.0, ONE).expect("coefficients");
    assert!(deviation(&basis, &plain, 31, plane) > 0.5);
    for loss in [Loss::Tukey, Loss::Huber] {
        let fit = robust(&basis, &all, loss, None, 0.0, ONE).expect("a fit");
        let error = deviation(&basis, &fit.coefficients, 31, plane);
        assert!(error < 1e-8, "{loss:?}: {error}, {fit:?}");
        let mut rejected = Vec::new();
        let count = fit.rejected(&basis, &all, ONE, |one| rejected.push(one.index)).expect("residuals");
        assert_eq!(count as usize, rejected.len());
        let outliers: Vec<u64> = (0..4_000).filter(|i| i % 10 == 3).collect();
        assert!(outliers.iter().all(|index| rejected.binary_search(index).is_ok()), "{loss:?}");
    }
}

#[test]
fn noise_is_measured_and_kept() {
    let basis = pulled_apart(&grid(4, 0.2));
    let all = with_outliers(6_000, 0.05);
    let fit = robust(&basis, &all, Loss::Tukey, None, 0.0, ONE).expect("a fit");
    assert!(fit.has_converged);
    assert!((0.045..0.062).contains(&fit.scale), "{}", fit.scale);
    assert!(deviation(&basis, &fit.coefficients, 31, plane) < 0.1);
    let mut wrong = 0;
    let count = fit
        .rejected(&basis, &all, ONE, |one| {
            wrong += u32::from(one.index % 10 != 3);
            assert!(one.residual > 4.6 * fit.scale || one.index % 10 != 3);
            assert_eq!(all[one.index as usize].point, one.point);
        })
        .expect("residuals");
    assert!(count >= 600 && wrong <= 3, "{count} rejected, {wrong} of them wrongly");
    let two =
        robust(&basis, &all, Loss::Tukey, None, 0.0, NonZeroUsize::new(2).expect("two")).expect("a fit");
    assert_eq!(fit, two);
}

#[test]
fn weights_count() {
    // A third of the observations is wrong, but has little weight.
    let basis = pulled_apart(&grid(2, 0.2));
    let mut all = scattered(3_000, 9, plane);
    let mut random = Random::new(2);
    for (i, one) in all.iter_mut().enumerate() {
        one.value += 0.01 * (random.unit() - 0.5);
        if i % 3 == 0 {
            (one.value, one.weight) = (one.value + 10.0 * (random.unit() - 0.5), 1e-6);
        }
    }
    let fit = robust(&basis, &all, Loss::Tukey, None, 0.0, ONE).expect("a fit");
    assert!(deviation(&basis, &fit.coefficients, 21, plane) < 0.01);
    assert_eq!(fit.rejected(&basis, &all, ONE, |_| ()).expect("residuals"), 0);
}

/// Observations of the plane at three places only, `times` at each, with errors.
fn at_three_places(times: [usize; 3]) -> Vec<Observation> {
    let places = [[0.2, 0.2], [0.8, 0.3], [0.4, 0.8]];
    let all = places.into_iter().zip(times).flat_map(|(place, times)| {
        let error = |i: usize| 0.01 * ((i % 7) as f64 - 3.0);
        (0..times).map(move |i| Observation::new(place, plane(place) + error(i)))
    });
    all.collect()
}

#[test]
fn three_places_make_a_plane() {
    let basis = pulled_apart(&grid(4, 0.2));
    let energy = bending(&basis).expect("an energy");
    let all = at_three_places([40; 3]);
    for (loss, lambda) in [(Loss::Huber, 0.0), (Loss::Tukey, 0.0), (Loss::Tukey, 1e-3)] {
        let fit = robust(&basis, &all, loss, Some(&energy), lambda, ONE).expect("a fit");
        assert!(fit.has_converged && fit.is_solved);
        let error = deviation(&basis, &fit.coefficients, 21, plane);
        assert!(error < 0.05, "{loss:?}, {lambda}: {error}");
    }
}

#[test]
fn weights_that_leave_too_little_are_the_reason_given() {
    let basis = pulled_apart(&grid(4, 0.2));
    let energy = bending(&basis).expect("an energy");
    // Most observations are equal. The others differ at each place, so they are far beyond the median of
    // residuals.
    let mut all = at_three_places([2; 3]);
    all.extend(vec![Observation::new([0.5, 0.5], plane([0.5, 0.5])); 100]);
    let normal = NormalEquations::of(&basis, &all, ONE).expect("equations");
    let said =
        |message: String| message.contains("on one line") && message.contains("robust weights leave out");
    let fit = robust(&basis, &all, Loss::Tukey, Some(&energy), 1e-3, ONE);
    assert!(fit.is_err_and(|error| said(error.to_string())));
    for method in [Method::Likelihood, Method::Generalised] {
        let choice = choose_robustly(&normal, &basis, &all, &energy, method, ONE);
        assert!(choice.is_err_and(|error| said(error.to_string())), "{method:?}");
    }
}

#[test]
fn trials_that_all_fail_are_an_error() {
    let basis = pulled_apart(&grid(2, 0.2));
    let energy = bending(&basis).expect("an energy");
    // As many observations as linear functions.
    let all = at_three_places([1; 3]);
    let normal = NormalEquations::of(&basis, &all, ONE).expect("equations");
    let choice = choose_robustly(&normal, &basis, &all, &energy, Method::Likelihood, ONE);
    let error = choice.expect_err("nothing is left to choose").to_string();
    assert!(error.contains("no more observations than effective coefficients"), "{error}");
}

/// About normally distributed noise.
fn noise(random: &mut Random) -> f64 {
    (0..12).map(|_| random.unit()).sum::<f64>() - 6.0
}

#[test]
fn edges_are_no_gross_errors() {
    // A ditch narrower than the cells of knots, and gross errors: the ditch is kept.
    let basis = pulled_apart(&grid(12, 0.2));
    let energy = bending(&basis).expect("an energy");
    let is_ditch = |[x, _]: [f64; 2]| (x - 0.52).abs() < 0.03;
    let mut all = scattered(6_000, 17, |x| if is_ditch(x) { -1.0 } else { 0.0 });
    let mut random = Random::new(5);
    for (i, one) in all.iter_mut().enumerate() {
        one.value += 0.02 * noise(&mut random) + if i % 20 == 3 { 5.0 + 20.0 * random.unit() } else { 0.0 };
    }
    let normal = NormalEquations::of(&basis, &all, ONE).expect("equations");
    let lambda = normal.default_lambda(&basis);
    let fit = robust(&basis, &all, Loss::Tukey, Some(&energy), lambda, ONE).expect("a fit");
    let (mut ditch, mut gross, mut other) = (0, 0, 0);
    fit.rejected(&basis, &all, ONE, |one| match one.index % 20 {
        3 => gross += 1,
        _ if is_ditch(one.point) => ditch += 1,
        _ => other += 1,
    })
    .expect("residuals");
    let count = all.iter().filter(|one| is_ditch(one.point)).count();
    println!("{ditch} of {count} in the ditch, {other} others, {gross} gross errors are rejected");
    assert!(gross >= 295 && ditch < count / 10 && other < 60, "{ditch} of {count}, {gross}, {other}");
}

#[test]
fn the_scale_is_that_of_errors_where_the_spline_follows_them() {
    // Half as many functions as observations.
    let basis = pulled_apart(&grid(20, 0.2));
    let energy = bending(&basis).expect("an energy");
    let mut all = scattered(2 * basis.len(), 8, |[x, y]| (9.0 * x).sin() * (11.0 * y).cos());
    let mut random = Random::new(6);
    all.iter_mut().for_each(|one| one.value += 0.05 * noise(&mut random));
    let normal = NormalEquations::of(&basis, &all, ONE).expect("equations");
    let (choice, start) =
        choose_robustly(&normal, &basis, &all, &energy, Method::Likelihood, ONE).expect("a choice");
    let lambda = choice.best.lambda;
    let fit = robust_on(start, &basis, &all, Loss::Huber, Some(&energy), lambda, ONE).expect("a fit");
    assert!((0.044..0.056).contains(&fit.scale), "{}", fit.scale);
}

/// Observations that count passes.
struct Counted {
    all: Vec<Observation>,
    passes: Cell<usize>,
}

impl Observations for Counted {
    fn read(&self) -> Result<Box<dyn ObservationReader + '_>> {
        self.passes.set(self.passes.get() + 1);
        self.all.read()
    }
}

#[test]
fn a_choice_takes_few_rounds() {
    let basis = pulled_apart(&grid(10, 0.2));
    let energy = bending(&basis).expect("an energy");
    let counted = Counted { all: with_outliers(3_000, 0.3), passes: Cell::new(0) };
    let normal = NormalEquations::of(&basis, &counted, ONE).expect("equations");
    let (choice, start) =
        choose_robustly(&normal, &basis, &counted, &energy, Method::Likelihood, ONE).expect("a choice");
    let of_choice = counted.passes.replace(0);
    assert!(of_choice <= 24, "{of_choice} passes");
    // The fit continues from the choice.
    let lambda = choice.best.lambda;
    let fit = robust_on(start, &basis, &counted, Loss::Tukey, Some(&energy), lambda, ONE).expect("a fit");
    let of_fit = counted.passes.get();
    assert!(fit.has_converged && of_fit <= 12, "{of_fit} passes");
    assert!(deviation(&basis, &fit.coefficients, 31, plane) < 0.1);
}

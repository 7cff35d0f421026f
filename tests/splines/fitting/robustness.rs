//! Fits that resist gross errors.

use super::bases::{ONE, deviation, grid, pulled_apart, scattered};
use spmesh_reference::sets::Random;
use spmesh_splines::fitting::{Loss, Observation, least_squares, robust};
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

//! Adding knots where they are needed.

use super::bases::{ONE, pulled_apart, scattered};
use super::fits::{least_squares, summarise};
use spmesh_reference::sets::Random;
use spmesh_splines::fitting::{Goal, Observation, refine};
use std::num::NonZeroUsize;

/// A ridge along a diagonal line.
fn ridge([x, y]: [f64; 2]) -> f64 {
    let across = (x + 0.3 * y - 0.6) / 0.06;
    0.5 * x + (-across * across).exp()
}

/// A square grid of slightly moved knots.
fn uniform(cells: usize) -> Vec<[f64; 2]> {
    super::bases::grid(cells, 0.2)
}

#[test]
fn ridges_take_fewer_knots_than_uniform_ones() {
    let all = scattered(40_000, 17, ridge);
    let goal = Goal::new(0.01, 1_000);
    let refined = refine(&all, &goal, ONE).expect("a spline");
    assert!(refined.is_reached, "{:?}", refined.rounds);
    let knots = refined.space.mesh.points().len();
    let summary = summarise(&refined.space.basis, &refined.coefficients, &all, ONE).expect("residuals");
    let last = refined.rounds.last().expect("a round");
    assert_eq!(summary.outside, 0, "the box of the data is the domain");
    assert_eq!(summary.worst.expect("residuals").residual.abs(), last.greatest);
    assert!(last.greatest <= 0.01 && last.knots == knots);
    assert!(refined.rounds.windows(2).all(|pair| pair[0].knots < pair[1].knots));
    let cells = (1..).take_while(|cells| (cells + 1) * (cells + 1) <= 13 * knots / 10).last().expect("cells");
    let grid = pulled_apart(&uniform(cells));
    let coefficients = least_squares(&grid, &all, 0.0, ONE).expect("coefficients");
    let of_grid = summarise(&grid, &coefficients, &all, ONE).expect("residuals").worst.expect("residuals");
    let found = of_grid.residual.abs();
    assert!(
        found > 0.01,
        "a grid of {} knots has {found}, {knots} knots have {}",
        (cells + 1).pow(2),
        last.greatest
    );
}

#[test]
fn knots_do_not_depend_on_threads() {
    let all = scattered(5_000, 18, ridge);
    let goal = Goal::new(0.02, 200);
    let [one, two] = [1, 2]
        .map(|threads| refine(&all, &goal, NonZeroUsize::new(threads).expect("threads")).expect("a spline"));
    assert_eq!(one.rounds, two.rounds);
    assert_eq!(one.coefficients, two.coefficients);
    assert!(one.rounds.iter().all(|round| round.knots <= 200));
}

#[test]
fn quadratic_polynomials_take_no_knot() {
    let all = scattered(500, 19, |[x, y]| 3.0 * x * x - x * y + 2.0);
    let refined = refine(&all, &Goal { smoothing: 1e-9, ..Goal::new(1e-4, 100) }, ONE).expect("a spline");
    assert!(refined.is_reached && refined.rounds.len() == 1, "{:?}", refined.rounds);
}

#[test]
fn noise_stops_where_observations_end() {
    let mut random = Random::new(5);
    let mut all = scattered(400, 6, |_| 0.0);
    all.iter_mut().for_each(|one| one.value = random.unit());
    let refined = refine(&all, &Goal::new(1e-6, 100_000), ONE).expect("a spline");
    assert!(!refined.is_reached);
    assert!(refined.rounds.last().expect("a round").knots < 400);
}

#[test]
fn areas_without_observations_get_no_knots() {
    let mut all = scattered(20_000, 7, ridge);
    all.retain(|one| one.point[1] < 0.4 || one.point[0] > 0.97);
    let refined = refine(&all, &Goal::new(0.01, 600), ONE).expect("a spline");
    // At the edge of the gap, a triangle may have too few observations to be divided.
    assert!(refined.rounds.last().expect("a round").above < 10, "{:?}", refined.rounds);
    let is_in_gap = |[x, y]: [f64; 2]| x < 0.85 && y > 0.7;
    let sites = (0..refined.space.basis.len()).map(|function| refined.space.basis.greville(function));
    assert!(sites.filter(|&site| is_in_gap(site)).count() < 60);
}

#[test]
fn goals_and_data_that_make_no_sense_are_refused() {
    let good = scattered(100, 8, ridge);
    let said =
        |all: &Vec<Observation>, goal: Goal| refine(all, &goal, ONE).expect_err("an error").to_string();
    assert!(said(&good, Goal::new(0.0, 100)).contains("tolerance 0"));
    assert!(said(&good, Goal::new(f64::NAN, 100)).contains("tolerance NaN"));
    assert!(said(&good, Goal::new(1.0, 28)).contains("28 knots"));
    assert!(said(&good, Goal { smoothing: 0.0, ..Goal::new(1.0, 40) }).contains("smoothing 0"));
    assert!(said(&Vec::new(), Goal::new(1.0, 40)).contains("no observations"));
    let line: Vec<Observation> =
        good.iter().map(|one| Observation { point: [one.point[0], 7.0], ..*one }).collect();
    assert!(said(&line, Goal::new(1.0, 40)).contains("no area"));
    let mut bad = good.clone();
    bad[9].value = f64::NAN;
    assert!(said(&bad, Goal::new(1.0, 40)).contains("observation 9"));
}

//! The in-sphere determinant of weighted points: the lift of a point is less by its weight.
//!
//! Of a tetrahedron with weights there is one sphere, the orthosphere, to which all four points have the same
//! power distance zero: |centre - p|^2 - radius^2 = weight. A fifth point is in conflict with the tetrahedron
//! if its power distance is below its weight.
//!
//! Source: Edelsbrunner, "Geometry and Topology for Mesh Generation", 2001, chapter 1; ties as in Devillers
//! and Teillaud, "Perturbations for Delaunay and weighted Delaunay 3D triangulations", 2011.

use super::filter::{lift, power_is_certain};
use super::float::differences_from;
use super::{Point3, PredicateCounts, Sign};
use crate::predicates::exact_integers::{integers_in, unit_with_weights, weight_in};
use crate::predicates::forms::{Form, Insphere, lift as form_lift};
use num_bigint::BigInt;

/// Greatest difference of coordinates for `i128`: squares are at most 3 D^2, and with weights whose
/// differences are at most D^2, lifts 4 D^2; a determinant of differences is at most 2 D^3. So the sum of
/// four products is at most 32 D^5 < 1.65e38 < 2^127.
const SIDE_MAX: f64 = 2.2e7;

/// Side of e against the orthosphere of a, b, c, d, given the weights of all five in this order: positive if
/// e is in conflict, zero if it is orthogonal.
///
/// Domain: abcd positively oriented; finite coordinates and weights.
pub(super) fn power_side(
    abcd: [Point3; 4],
    e: Point3,
    weights: [f64; 5],
    counts: &mut PredicateCounts,
) -> Sign {
    let differences = differences_from(e, abcd);
    let heavier: [f64; 4] = std::array::from_fn(|i| weights[i] - weights[4]);
    let squares = differences.map(lift);
    let lifts: [f64; 4] = std::array::from_fn(|i| squares[i] - heavier[i]);
    let value = Insphere::value(&differences, |i| lifts[i]);
    let greatest = squares.into_iter().chain(lifts.map(f64::abs)).fold(0.0, f64::max);
    if power_is_certain(value, greatest) {
        counts.filter += 1;
        return Sign::of(value);
    }
    if let Some(sign) = in_i128(&differences, &heavier, &abcd, e, &weights) {
        counts.integer += 1;
        return sign;
    }
    counts.bigint += 1;
    in_big_integers(abcd, e, weights)
}

/// The sign, if all numbers are integers that are small enough.
fn in_i128(
    differences: &[Point3; 4],
    heavier: &[f64; 4],
    abcd: &[Point3; 4],
    e: Point3,
    weights: &[f64; 5],
) -> Option<Sign> {
    let is_integer = |value: &f64| value.fract() == 0.0 && value.abs() < 9e15;
    let mut numbers = abcd.iter().flatten().chain(&e).chain(weights);
    let is_small = differences.iter().flatten().all(|d| d.abs() <= SIDE_MAX)
        && heavier.iter().all(|w| w.abs() <= SIDE_MAX * SIDE_MAX);
    if !(is_small && numbers.all(is_integer)) {
        return None;
    }
    let vectors = differences.map(|vector| vector.map(|d| d as i128));
    Some(Sign::of(Insphere::value(&vectors, |i| form_lift(&vectors[i]) - heavier[i] as i128)))
}

/// The sign in arbitrary precision.
fn in_big_integers([a, b, c, d]: [Point3; 4], e: Point3, weights: [f64; 5]) -> Sign {
    let points = [a, b, c, d, e];
    let unit = unit_with_weights(&points, &weights);
    let integers = points.map(|point| integers_in(point, unit));
    let weights = weights.map(|weight| weight_in(weight, unit));
    let vectors: [[BigInt; 3]; 4] =
        std::array::from_fn(|i| std::array::from_fn(|axis| &integers[i][axis] - &integers[4][axis]));
    Sign::of(Insphere::value::<BigInt>(&vectors, |i| form_lift(&vectors[i]) - (&weights[i] - &weights[4])))
}

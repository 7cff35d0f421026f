//! Which of two points is nearer to a third one, exactly.

use super::adaptive::UNIT_ROUNDOFF;
use super::exact_integers::integers_of;
use num_bigint::BigInt;
use std::cmp::Ordering;

/// The relative error of a squared distance: a difference has one rounding, which counts twice in its square,
/// the square one, and a sum of three two at most. Half a unit more than covers products of roundings.
const BOUND: f64 = 5.5 * UNIT_ROUNDOFF;

/// Squared distances between these neither overflow, nor does an underflow of a square matter: it is below
/// 2^-1074, far less than a rounding of the sum.
const TRUSTED: std::ops::RangeInclusive<f64> =
    f64::from_bits((1023 - 900) << 52)..=f64::from_bits((1023 + 1000) << 52);

/// Integers up to this have differences whose squares sum up in `i128`.
const GREATEST_INTEGER: f64 = (1u64 << 53) as f64;

/// Compares the distances of p and q from the target: `Less` if p is nearer.
///
/// Domain: finite coordinates. Cost: nanoseconds; ties of integers some more, other ties a microsecond.
pub(crate) fn nearer<const D: usize>(target: [f64; D], p: [f64; D], q: [f64; D]) -> Ordering {
    let (of_p, of_q) = (square(target, p), square(target, q));
    if TRUSTED.contains(&of_p) && TRUSTED.contains(&of_q) && (of_p - of_q).abs() > BOUND * (of_p + of_q) {
        return of_p.total_cmp(&of_q);
    }
    let is_integer = |x: &f64| x.abs() <= GREATEST_INTEGER && x.trunc() == *x;
    if [target, p, q].iter().flatten().all(is_integer) {
        return integer_square(target, p).cmp(&integer_square(target, q));
    }
    exactly(target, p, q)
}

/// The squared distance, rounded.
#[inline(always)]
fn square<const D: usize>(p: [f64; D], q: [f64; D]) -> f64 {
    (0..D).map(|axis| (p[axis] - q[axis]) * (p[axis] - q[axis])).sum()
}

fn integer_square<const D: usize>(p: [f64; D], q: [f64; D]) -> i128 {
    let difference = |axis: usize| i128::from(p[axis] as i64 - q[axis] as i64);
    (0..D).map(|axis| difference(axis) * difference(axis)).sum()
}

#[cold]
fn exactly<const D: usize>(target: [f64; D], p: [f64; D], q: [f64; D]) -> Ordering {
    let integers = integers_of(&[target, p, q]);
    let square = |i: usize| -> BigInt {
        let differences = (0..D).map(|axis| &integers[i][axis] - &integers[0][axis]);
        differences.map(|difference| &difference * &difference).sum()
    };
    square(1).cmp(&square(2))
}

//! Which of two points is nearer to a third one, exactly.

use super::adaptive::UNIT_ROUNDOFF;
use super::area::two_sum;
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

/// Compares the distances of p and q from the target: `Less` if p is nearer.
///
/// Domain: finite coordinates. Cost: nanoseconds; ties on a grid some more, other ties a microsecond.
pub(crate) fn nearer<const D: usize>(target: [f64; D], p: [f64; D], q: [f64; D]) -> Ordering {
    let (of_p, of_q) = (square(target, p), square(target, q));
    if TRUSTED.contains(&of_p) && TRUSTED.contains(&of_q) && (of_p - of_q).abs() > BOUND * (of_p + of_q) {
        return of_p.total_cmp(&of_q);
    }
    if let (Some(of_p), Some(of_q)) = (exact_square(target, p), exact_square(target, q)) {
        return of_p.total_cmp(&of_q);
    }
    exactly(target, p, q)
}

/// The squared distance, rounded.
#[inline(always)]
fn square<const D: usize>(p: [f64; D], q: [f64; D]) -> f64 {
    (0..D).map(|axis| (p[axis] - q[axis]) * (p[axis] - q[axis])).sum()
}

/// The squared distance, if nothing is rounded: for ties on a grid. Differences of at most 24 digits in the
/// range of `f32` have squares of at most 48 digits, far from underflow.
fn exact_square<const D: usize>(p: [f64; D], q: [f64; D]) -> Option<f64> {
    let mut sum = 0.0;
    for axis in 0..D {
        let difference = p[axis] - q[axis];
        let square = difference * difference;
        let is_exact = two_sum(p[axis], -q[axis])[1] == 0.0
            && f64::from(difference as f32) == difference
            && two_sum(sum, square)[1] == 0.0;
        if !is_exact {
            return None;
        }
        sum += square;
    }
    Some(sum)
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

//! Predicates in arbitrary precision: finite `f64` are dyadic rationals, so scaled by one power of two they are
//! integers. Right for every finite input; a call costs microseconds.

use super::{Point2, Sign};
use num_bigint::BigInt;

/// Significand and exponent: `value == significand * 2^exponent`.
fn decompose(value: f64) -> (i64, i32) {
    debug_assert!(value.is_finite());
    let bits = value.to_bits();
    let biased = ((bits >> 52) & 0x7ff) as i32;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    let (significand, exponent) =
        if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
    (if value.is_sign_negative() { -significand } else { significand }, exponent)
}

/// The points times the least power of two that makes all coordinates integers of the same unit.
fn integers<const N: usize>(points: [Point2; N]) -> [[BigInt; 2]; N] {
    let parts = points.map(|point| point.map(decompose));
    let unit = parts.iter().flatten().filter(|part| part.0 != 0).map(|part| part.1).min().unwrap_or(0);
    parts.map(|point| {
        point.map(|(significand, exponent)| match significand {
            0 => BigInt::from(0),
            _ => BigInt::from(significand) << (exponent - unit) as usize,
        })
    })
}

fn difference(p: &[BigInt; 2], q: &[BigInt; 2]) -> [BigInt; 2] {
    [&p[0] - &q[0], &p[1] - &q[1]]
}

fn cross(p: &[BigInt; 2], q: &[BigInt; 2]) -> BigInt {
    &p[0] * &q[1] - &p[1] * &q[0]
}

fn lift(p: &[BigInt; 2]) -> BigInt {
    &p[0] * &p[0] + &p[1] * &p[1]
}

/// Orientation of abc.
pub(super) fn orient2d(a: Point2, b: Point2, c: Point2) -> Sign {
    let [a, b, c] = integers([a, b, c]);
    Sign::of(cross(&difference(&a, &c), &difference(&b, &c)))
}

/// Side of d against the circle through a, b, c, counterclockwise.
pub(super) fn incircle(a: Point2, b: Point2, c: Point2, d: Point2) -> Sign {
    let [a, b, c, d] = integers([a, b, c, d]);
    let (a, b, c) = (difference(&a, &d), difference(&b, &d), difference(&c, &d));
    Sign::of(lift(&a) * cross(&b, &c) + lift(&b) * cross(&c, &a) + lift(&c) * cross(&a, &b))
}

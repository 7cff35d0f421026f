//! Predicates in arbitrary precision: finite `f64` are dyadic rationals, so scaled by one power of two they are
//! integers. Right for every finite input; a call costs microseconds.

use super::{Point2, Point3, Sign};
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
pub(crate) fn integers<const N: usize, const D: usize>(points: [[f64; D]; N]) -> [[BigInt; D]; N] {
    let unit = unit(&points);
    points.map(|point| scaled(point, unit))
}

/// The same for any number of points.
pub(crate) fn integers_of<const D: usize>(points: &[[f64; D]]) -> Vec<[BigInt; D]> {
    let unit = unit(points);
    points.iter().map(|&point| scaled(point, unit)).collect()
}

/// The least exponent.
fn unit<const D: usize>(points: &[[f64; D]]) -> i32 {
    let parts = points.iter().flatten().map(|&coordinate| decompose(coordinate));
    parts.filter(|part| part.0 != 0).map(|part| part.1).min().unwrap_or(0)
}

fn scaled<const D: usize>(point: [f64; D], unit: i32) -> [BigInt; D] {
    point.map(decompose).map(|(significand, exponent)| match significand {
        0 => BigInt::from(0),
        _ => BigInt::from(significand) << (exponent - unit) as usize,
    })
}

fn difference<const D: usize>(p: &[BigInt; D], q: &[BigInt; D]) -> [BigInt; D] {
    std::array::from_fn(|axis| &p[axis] - &q[axis])
}

fn cross(p: &[BigInt; 2], q: &[BigInt; 2]) -> BigInt {
    &p[0] * &q[1] - &p[1] * &q[0]
}

/// Determinant of the rows p, q, r.
fn volume(p: &[BigInt; 3], q: &[BigInt; 3], r: &[BigInt; 3]) -> BigInt {
    &r[0] * (&p[1] * &q[2] - &p[2] * &q[1])
        + &r[1] * (&p[2] * &q[0] - &p[0] * &q[2])
        + &r[2] * (&p[0] * &q[1] - &p[1] * &q[0])
}

fn lift<const D: usize>(p: &[BigInt; D]) -> BigInt {
    p.iter().map(|coordinate| coordinate * coordinate).sum()
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

/// Orientation of abcd.
pub(super) fn orient3d(a: Point3, b: Point3, c: Point3, d: Point3) -> Sign {
    let [a, b, c, d] = integers([a, b, c, d]);
    Sign::of(volume(&difference(&b, &a), &difference(&c, &a), &difference(&d, &a)))
}

/// Side of e against the sphere through a, b, c, d, positively oriented.
pub(super) fn insphere(a: Point3, b: Point3, c: Point3, d: Point3, e: Point3) -> Sign {
    let [a, b, c, d, e] = integers([a, b, c, d, e]);
    let [a, b, c, d] = [a, b, c, d].map(|point| difference(&point, &e));
    Sign::of(
        lift(&a) * volume(&b, &c, &d) - lift(&b) * volume(&a, &c, &d) + lift(&c) * volume(&a, &b, &d)
            - lift(&d) * volume(&a, &b, &c),
    )
}

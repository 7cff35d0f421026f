//! Predicates in arbitrary precision, for every finite input. A call costs microseconds.

use super::exact_integers::integers;
use super::{Point2, Point3, Sign};
use num_bigint::BigInt;

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

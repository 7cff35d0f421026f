//! The canonical perturbation: how four cocircular points are told apart.

use super::{Point2, Predicates2, Sign};
use std::cmp::Ordering;

/// Lexicographic order of two points, x before y; `-0.0` equals `0.0`. Domain: no NaN.
#[inline(always)]
#[must_use]
pub fn lexicographic(a: Point2, b: Point2) -> Ordering {
    if (a[0], a[1]) < (b[0], b[1]) {
        Ordering::Less
    } else if (b[0], b[1]) < (a[0], a[1]) {
        Ordering::Greater
    } else {
        Ordering::Equal
    }
}

/// In-circle sign of four distinct cocircular points, abc counterclockwise, under the perturbation.
///
/// The point of largest rank dominates. If it is d, its lift rises above the plane of the others: outside.
/// If it is a vertex of the triangle, the derivative of the determinant in its lift is the orientation of the
/// triangle with that vertex replaced by d. No three of four distinct points of a circle are collinear, so that
/// orientation is never zero and smaller ranks are never asked.
#[cold]
pub(super) fn cocircular<P: Predicates2 + ?Sized>(
    predicates: &mut P,
    a: Point2,
    b: Point2,
    c: Point2,
    d: Point2,
) -> Sign {
    predicates.counts_mut().perturbed += 1;
    let above = |p, q| lexicographic(p, q) == Ordering::Greater;
    let sign = if above(d, a) && above(d, b) && above(d, c) {
        Sign::Negative
    } else if above(a, b) && above(a, c) {
        predicates.orient2d(d, b, c)
    } else if above(b, c) {
        predicates.orient2d(a, d, c)
    } else {
        predicates.orient2d(a, b, d)
    };
    debug_assert_ne!(sign, Sign::Zero, "four distinct points of a circle");
    sign
}

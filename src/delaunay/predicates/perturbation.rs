//! The canonical perturbation, which decides ties between four cocircular or five cospherical points.

use super::{Point2, Point3, Predicates2, Predicates3, Sign};
use super::{big, forms::Orient3d};
use std::cmp::Ordering;

/// Lexicographic order of two points, x before y before z; `-0.0` equals `0.0`. Domain: no NaN.
#[inline(always)]
pub fn lexicographic<const D: usize>(a: [f64; D], b: [f64; D]) -> Ordering {
    for (a, b) in a.into_iter().zip(b) {
        if a < b {
            return Ordering::Less;
        }
        if b < a {
            return Ordering::Greater;
        }
    }
    Ordering::Equal
}

/// In-circle sign of four distinct cocircular points, abc counterclockwise, under the perturbation.
///
/// The point of largest rank dominates. If it is d, its lift rises above the plane of the others: outside. If
/// it is a vertex of the triangle, the derivative of the determinant in its lift is the orientation of the
/// triangle with that vertex replaced by d. No three of four distinct points of a circle are collinear, so
/// that orientation is never zero and smaller ranks never matter.
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

/// In-sphere sign of five distinct cospherical points, abcd positively oriented, under the perturbation.
///
/// As in the plane, the point of largest rank dominates, but a vertex does not decide if the tetrahedron with
/// that vertex replaced by e is flat: the next rank does. It always decides. If e lay in the planes of two
/// facets it would be on the line of the edge that these share, and on the sphere, so equal to an end of the
/// edge. With weights it may be there; then the ends of that edge decide, as it is in no third plane.
#[inline(never)]
pub(super) fn cospherical<P: Predicates3 + ?Sized>(
    predicates: &mut P,
    [a, b, c, d]: [Point3; 4],
    e: Point3,
) -> Sign {
    debug_assert_eq!(big::sign::<Orient3d, 3, 3>(a, [b, c, d]), Sign::Positive, "{:?}", [a, b, c, d]);
    debug_assert!(![a, b, c, d].contains(&e), "{e:?} is a vertex");
    predicates.counts_mut().perturbed += 1;
    let points = [a, b, c, d, e];
    let mut left = [0, 1, 2, 3, 4];
    // The first place nearly always decides, so that sorting all of them does not pay.
    for count in (1..=5).rev() {
        let mut last = 0;
        for i in 1..count {
            if lexicographic(points[left[i]], points[left[last]]) == Ordering::Greater {
                last = i;
            }
        }
        let sign = match left[last] {
            0 => predicates.orient3d(e, b, c, d),
            1 => predicates.orient3d(a, e, c, d),
            2 => predicates.orient3d(a, b, e, d),
            3 => predicates.orient3d(a, b, c, e),
            _ => Sign::Negative,
        };
        if sign != Sign::Zero {
            return sign;
        }
        left[last] = left[count - 1];
    }
    Sign::Zero
}

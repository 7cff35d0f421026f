//! Centres of the circles and spheres through points, accurate however flat the triangle or tetrahedron is.

use super::adaptive::{BoundedFloatPredicates, FiniteFloatPredicates, UNIT_ROUNDOFF, difference};
use super::area::exact_area;
use super::exact_integers::{integers_and_unit, quotient};
use super::forms::{Magnitude, Number, cross, dot, lift, minor, times};
use super::{Point2, Point3};
use crate::points::is_finite;
use num_bigint::BigInt;

/// Errors of centres are at most this times the radius.
const GREATEST_ERROR: f64 = 1e-12;

/// The sum of the two products of a determinant, as a multiple of the determinant, up to which plain
/// arithmetic is used.
const TRUSTED: f64 = 16.0;

/// A centre as seen from one of the points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Centre2 {
    /// The point.
    pub(crate) origin: Point2,
    /// The way from there to the centre; not finite if it overflows.
    pub(crate) offset: [f64; 2],
    /// Bound of the length of its error.
    pub(crate) error: f64,
}

impl Centre2 {
    /// The centre of the circle through three points.
    ///
    /// Domain: the points are not collinear, in the range of [`BoundedFloatPredicates`].
    ///
    /// The origin is the point at the greatest angle, so that the sides e and f from there are at most as
    /// long as e - f. The numerator m = |e|^2 f - |f|^2 e has length |e| |f| |e - f|, which is at least half
    /// of the sum of the lengths of its two terms: nothing cancels. With u = 2^-53, a term has relative error
    /// 7 u (two differences in the square, its products and sum, another difference, the product), which
    /// makes 14 u of m, and its sum another u. The determinant d of e and f is off by 5 u of the sum of its
    /// products, which is k |d|, or is exact up to 4 u; the quotient is rounded once. So the error is at most
    /// (16 + 5 k) u of the radius. One u more covers terms of order u^2.
    pub(crate) fn of(a: Point2, b: Point2, c: Point2) -> Centre2 {
        let square = |p, q| lift(&difference(p, q));
        let (ab, bc, ca) = (square(a, b), square(b, c), square(c, a));
        let [a, b, c] = match () {
            () if bc >= ab && bc >= ca => [a, b, c],
            () if ca >= ab => [b, c, a],
            () => [c, a, b],
        };
        let (e, f) = (difference(b, a), difference(c, a));
        let (left, right) = (e[0] * f[1], e[1] * f[0]);
        let (mut doubled, mut k) = (2.0 * (left - right), 1.0);
        let magnitude = left.abs() + right.abs();
        if 2.0 * magnitude > TRUSTED * doubled.abs() {
            doubled = 4.0 * exact_area(a, b, c);
        } else {
            k = 2.0 * magnitude / doubled.abs();
        }
        let offset = numerators2(&[e, f]).0.map(|numerator| numerator / doubled);
        let error = (17.0 + 5.0 * k) * UNIT_ROUNDOFF * (offset[0].abs() + offset[1].abs());
        Centre2 { origin: a, offset, error }
    }
}

/// Whether [`Centre2::of`] is for this point.
pub(crate) fn is_bounded(point: &Point2) -> bool {
    BoundedFloatPredicates::covers_point(point)
}

/// The centre of the circle through three points that are not collinear: off by at most 1e-12 of the radius
/// and one unit in the last place of each coordinate. `None` if it overflows.
pub(crate) fn circumcentre2([a, b, c]: [Point2; 3]) -> Option<Point2> {
    let centre = if [a, b, c].iter().all(is_bounded) {
        let Centre2 { origin, offset, .. } = Centre2::of(a, b, c);
        [origin[0] + offset[0], origin[1] + offset[1]]
    } else {
        exact([a, b, c], |[a, b, c]| [minus(b, a), minus(c, a)], numerators2)
    };
    is_finite(&centre).then_some(centre)
}

/// The same for the sphere through four points that are not coplanar.
///
/// In plain arithmetic, the numerators of four factors are off by at most 13 u of the sum of their products
/// (four differences, three roundings in a square, two in a minor, one product and two sums), the determinant
/// by 9 u, likewise.
pub(crate) fn circumcentre3([a, b, c, d]: [Point3; 4]) -> Option<Point3> {
    let sides = [difference(b, a), difference(c, a), difference(d, a)];
    let (numerators, determinant) = numerators3(&sides);
    let (magnitudes, magnitude) = numerators3(&sides.map(|side| side.map(|x| Magnitude(x.abs()))));
    let margin = determinant.abs() - 9.0 * UNIT_ROUNDOFF * magnitude.0;
    let offset = numerators.map(|numerator| numerator / (2.0 * determinant));
    let error = |axis: usize| {
        let of_determinant = 18.0 * UNIT_ROUNDOFF * magnitude.0 * offset[axis].abs();
        (13.0 * UNIT_ROUNDOFF * magnitudes[axis].0 + of_determinant) / (2.0 * margin)
    };
    let (errors, length): (f64, f64) =
        ((0..3).map(error).sum(), offset.iter().fold(0.0, |most, x| x.abs().max(most)));
    // Half of the bound is for terms of order u^2 and the roundings of the bound. False for NaN, too.
    let is_good = margin > 0.0 && errors <= 0.5 * GREATEST_ERROR * length;
    let centre = if is_good && sides.iter().all(FiniteFloatPredicates::trusts) {
        [0, 1, 2].map(|axis| a[axis] + offset[axis])
    } else {
        exact([a, b, c, d], |[a, b, c, d]| [minus(b, a), minus(c, a), minus(d, a)], numerators3)
    };
    is_finite(&centre).then_some(centre)
}

fn minus<const D: usize>(p: &[BigInt; D], q: &[BigInt; D]) -> [BigInt; D] {
    std::array::from_fn(|axis| &p[axis] - &q[axis])
}

/// The centre in exact integers.
#[cold]
fn exact<const N: usize, const M: usize, const D: usize>(
    points: [[f64; D]; N],
    sides: impl Fn(&[[BigInt; D]; N]) -> [[BigInt; D]; M],
    form: impl Fn(&[[BigInt; D]; M]) -> ([BigInt; D], BigInt),
) -> [f64; D] {
    let (integers, unit) = integers_and_unit(points);
    let (numerators, determinant) = form(&sides(&integers));
    let doubled = determinant * 2;
    std::array::from_fn(|axis| quotient(&(&integers[0][axis] * &doubled + &numerators[axis]), &doubled, unit))
}

/// For the sides from one of three points to the others: numerators of the way from it to the centre, and
/// half of their denominator.
#[inline(always)]
pub(crate) fn numerators2<T: Number>([e, f]: &[[T; 2]; 2]) -> ([T; 2], T) {
    let (ee, ff) = (lift(e), lift(f));
    let x = times(&ee, &f[1]) - times(&ff, &e[1]);
    let y = times(&ff, &e[0]) - times(&ee, &f[0]);
    ([x, y], minor(e, f, 0, 1))
}

/// The same in space.
#[inline(always)]
fn numerators3<T: Number>([e, f, g]: &[[T; 3]; 3]) -> ([T; 3], T) {
    let (fg, ge, ef) = (cross(f, g), cross(g, e), cross(e, f));
    let lifts = [lift(e), lift(f), lift(g)];
    let numerator =
        |axis: usize| times(&lifts[0], &fg[axis]) + times(&lifts[1], &ge[axis]) + times(&lifts[2], &ef[axis]);
    ([numerator(0), numerator(1), numerator(2)], dot(e, &fg))
}

//! The determinants of space in `f64`, and how far rounding takes them from the exact ones.
//!
//! # Derivation
//!
//! Write u = 2^-53. Both determinants are sums of products of exact differences of coordinates. Evaluated in
//! `f64`, each of these products comes with a factor (1 + d1)(1 + d2)..., |di| <= u, one for each rounding on
//! its way into the sum; with at most n of them, the value is off by at most n u (1 + 2 n u) S, where S is
//! the sum of the magnitudes of the products. Fused operations round less often. In whatever order sums are
//! taken, and for every choice of the 2 by 2 minors, n is at most
//!
//! * `orient3d`, a cross product times a vector: 3 differences; product and difference of the minor; product
//!   with the third factor, and 2 sums: 8.
//! * `insphere`, four products of a square and an `orient3d` of the other three: 5 differences; product and 2
//!   sums of the square; 5 of the determinant without its differences; product with the square, and 3 sums:
//!   17.
//!
//! ## In terms of the magnitudes
//!
//! The same sum with every product replaced by its magnitude comes out as S^ >= (1 - n u) S. So the value has
//! the sign of the exact one if its magnitude is more than n u (1 + 2^-40) S^, the 2^-40 being far more than
//! what was left out. This is the filter of [`Estimate`].
//!
//! ## In terms of the lengths
//!
//! The magnitudes of the products of a determinant with rows p, q, r sum up to the permanent of the
//! magnitudes. A permanent is linear in each row and symmetric in the rows, so its greatest value for rows of
//! length 1 is attained where all rows are equal (Banach, 1938): 6 xyz <= 6 / 3^1.5. Hence S <= 2/sqrt(3) |p|
//! |q| |r| for `orient3d`, and with M the greatest square of a length, S <= 4 * 2/sqrt(3) M^2.5 for
//! `insphere`. Of the squares that were computed, 5 roundings each, M^2.5 is at most m^2.5 (1 + 13 u).
//!
//! So |value - exact| <= 8 u * 2/sqrt(3) sqrt(k l m) (1 + 100 u), and <= 17 u * 8/sqrt(3) m^2.5 (1 + 100 u).
//! The bounds are on the squares, which saves a root: 64 * 4/3 u^2 k l m, and 289 * 64/3 u^2 m^5. Their
//! constants are rounded up by one part in 10^4, which covers these 100 u and the roundings of both sides of
//! the comparison.
//!
//! ## With weights
//!
//! The lift of a point is then its square less a difference w of weights. Let G be the greatest magnitude of
//! a square or a lift; then |w| <= 2 G. A lift is off by 5 u of the square, by u |w|, and by u of itself: by
//! at most 8 u G. Each of the four products of a lift and a determinant is off by 8 u + 8 u, and with the
//! product itself and the 3 sums the value is off by at most 20 u * 8/sqrt(3) G^2.5. The bound has 22
//! instead. What is said of overflow and underflow holds with G in place of m: differences of weights do not
//! underflow, and with integers nothing is rounded below the same limit.
//!
//! ## Overflow and underflow
//!
//! * Overflow. If the right side is infinite or a NaN, or `value` is a NaN, the comparison is false. If it is
//!   finite, m^2.5 < 2^512 times a small constant, and nothing on the way to the value has overflown; should
//!   only the square of the value overflow, the comparison is rightly true. For `orient3d` the same holds in
//!   its domain, where k l < 2^808 does not overflow.
//! * Underflow, `insphere`, any finite coordinates. Differences and sums do not underflow, a product that
//!   does is off by at most 2^-1075. If m < 2^-202, the value is below 5 * 2^-505 < 2^-500, and the
//!   comparison with [`TINY`] = 2^-1000 is false. Else the errors of products and what they are multiplied by
//!   are in all below 2^-1069 max(1, m^1.5), which is less than 2^-500 u m^2.5. The fifth power of m does not
//!   underflow, and that its product with the bound may is nothing compared to `TINY`.
//! * Underflow, `orient3d`. With k = l = m any finite coordinates are fine, as before: below m = 2^-334 the
//!   comparison is false, above it errors of 2^-1071 max(1, sqrt(m)) do not matter, and the cube of m does
//!   not underflow. With different squares, coordinates have to be in the domain of
//!   [`super::BoundedFloatPredicates3`] or integers: all are multiples of 2^-184, squares are zero or at least
//!   2^-368, so that k l does not underflow, and whether its product with m does is nothing compared to
//!   `TINY`.

use crate::predicates::Point3;
use crate::predicates::adaptive::{Estimate, UNIT_ROUNDOFF};

const SLACK: f64 = 1.0 + 1.0 / (1u64 << 40) as f64;
const ORIENT3D_BOUND: f64 = 8.0 * UNIT_ROUNDOFF * SLACK;
const INSPHERE_BOUND: f64 = 17.0 * UNIT_ROUNDOFF * SLACK;

/// [`orient3d_is_certain`] if the square of the value is more than this times the squares of the three
/// lengths.
pub(crate) const ORIENT3D_SQUARED_BOUND: f64 = 64.0 * 4.0 / 3.0 * 1.0001 * UNIT_ROUNDOFF * UNIT_ROUNDOFF;

/// [`insphere_is_certain`] if the square of the value is more than this times the fifth power of the greatest
/// square.
pub(crate) const INSPHERE_SQUARED_BOUND: f64 = 289.0 * 64.0 / 3.0 * 1.0001 * UNIT_ROUNDOFF * UNIT_ROUNDOFF;

/// [`power_is_certain`] if the square of the value is more than this times the fifth power of the greatest
/// magnitude.
pub(crate) const POWER_SQUARED_BOUND: f64 = 484.0 * 64.0 / 3.0 * 1.0001 * UNIT_ROUNDOFF * UNIT_ROUNDOFF;

/// 2^-1000: added to the right side, makes the comparison false where products underflow.
pub(crate) const TINY: f64 = f64::from_bits((1023 - 1000) << 52);

/// Whether a computed det(p, q, r) of rounded differences has the sign of the exact one, given the product of
/// the computed squares of their lengths. The squares are multiplied one by one, or one is taken to the third
/// power.
///
/// Domain: numbers that are not [`super::Numbers::FiniteFloats`]; any if the product is a third power of the
/// greatest square.
#[inline(always)]
pub(crate) fn orient3d_is_certain(value: f64, squares: f64) -> bool {
    value * value > ORIENT3D_SQUARED_BOUND * squares + TINY
}

/// Whether the in-sphere determinant, computed of differences to one of the points, has the sign of the exact
/// one, given the greatest of the computed squares of their lengths.
///
/// Domain: any; false where a coordinate is a NaN.
#[inline(always)]
pub(crate) fn insphere_is_certain(value: f64, greatest_square: f64) -> bool {
    is_above(value, INSPHERE_SQUARED_BOUND, greatest_square)
}

/// The same with weights, given the greatest magnitude of a square or a lift.
#[inline(always)]
pub(crate) fn power_is_certain(value: f64, greatest: f64) -> bool {
    is_above(value, POWER_SQUARED_BOUND, greatest)
}

#[inline(always)]
fn is_above(value: f64, bound: f64, greatest: f64) -> bool {
    let square = greatest * greatest;
    value * value > bound * (square * square * greatest) + TINY
}

/// Square of the length.
#[inline(always)]
pub(super) fn lift(p: Point3) -> f64 {
    dot(p, p)
}

#[inline(always)]
fn dot(p: Point3, q: Point3) -> f64 {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}

/// A cross product, and the same with every product replaced by its magnitude.
#[derive(Clone, Copy)]
struct Cross {
    value: Point3,
    magnitude: Point3,
}

impl Cross {
    #[inline(always)]
    fn of(p: Point3, q: Point3) -> Cross {
        let minor = |i: usize, j: usize| (p[i] * q[j], p[j] * q[i]);
        let minors = [minor(1, 2), minor(2, 0), minor(0, 1)];
        Cross {
            value: minors.map(|(left, right)| left - right),
            magnitude: minors.map(|(left, right)| left.abs() + right.abs()),
        }
    }

    /// The determinant with a third row, and the sum of the magnitudes of its products.
    #[inline(always)]
    fn dot(&self, r: Point3) -> [f64; 2] {
        [dot(self.value, r), dot(self.magnitude, r.map(f64::abs))]
    }
}

impl Estimate {
    /// Orientation from the differences of b, c, d to a.
    #[inline(always)]
    pub(crate) fn orient3d([ab, ac, ad]: [Point3; 3]) -> Estimate {
        let [value, magnitude] = Cross::of(ab, ac).dot(ad);
        Estimate { value, magnitude, bound: ORIENT3D_BOUND }
    }

    /// In-sphere determinant from the differences of a, b, c, d to e.
    #[inline(always)]
    pub(super) fn insphere([ae, be, ce, de]: [Point3; 4]) -> Estimate {
        let (ab, cd) = (Cross::of(ae, be), Cross::of(ce, de));
        let [a, b, c, d] = [(ae, cd.dot(be)), (be, cd.dot(ae)), (ce, ab.dot(de)), (de, ab.dot(ce))]
            .map(|(opposite, determinant)| determinant.map(|d| lift(opposite) * d));
        Estimate {
            value: (a[0] - b[0]) + (c[0] - d[0]),
            magnitude: (a[1] + b[1]) + (c[1] + d[1]),
            bound: INSPHERE_BOUND,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::predicates::adaptive::difference;
    use crate::predicates::forms::{Insphere, Orient3d};
    use crate::predicates::{Sign, big};

    /// Pseudo-random numbers.
    struct Random(u64);

    impl Random {
        fn bits(&mut self) -> u64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            self.0 >> 11
        }

        /// In [-1, 1).
        fn unit(&mut self) -> f64 {
            self.bits() as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    /// The greatest error of `value` among the cases, as a share of the square root of `bound`.
    fn worst(mut case: impl FnMut(&mut Random) -> (f64, i128, f64), cases: u32) -> f64 {
        let mut random = Random(1);
        (0..cases)
            .map(|_| {
                let (value, exact, bound) = case(&mut random);
                // Both are integers of at most 126 bits; the difference of the rounded one is exact in these.
                (value as i128 - exact) as f64 / bound.sqrt()
            })
            .fold(0.0, |worst, share| share.abs().max(worst))
    }

    /// Integers of `bits` bits, or a little off those of another point, or of equal magnitude on all axes.
    fn integer_point(random: &mut Random, bits: u32, near: [i64; 3]) -> [i64; 3] {
        let kind = random.bits() % 4;
        let same = random.bits() as i64 >> (53 - bits);
        near.map(|c| match kind {
            0 => random.bits() as i64 >> (53 - bits),
            1 => c + (random.bits() % 64) as i64,
            2 => (same + (random.bits() % 8) as i64) * if random.bits().is_multiple_of(2) { 1 } else { -1 },
            _ => -c,
        })
    }

    fn volume(p: [i64; 3], q: [i64; 3], r: [i64; 3]) -> i128 {
        let [p, q, r] = [p, q, r].map(|p| p.map(i128::from));
        r[0] * (p[1] * q[2] - p[2] * q[1])
            + r[1] * (p[2] * q[0] - p[0] * q[2])
            + r[2] * (p[0] * q[1] - p[1] * q[0])
    }

    fn square(p: [i64; 3]) -> i128 {
        p.map(|c| i128::from(c) * i128::from(c)).iter().sum()
    }

    #[test]
    fn errors_of_exact_differences_are_far_within_the_bounds() {
        let orient3d = |random: &mut Random| {
            let first = integer_point(random, 40, [0; 3]);
            let points = [first, integer_point(random, 40, first), integer_point(random, 40, first)];
            let floats = points.map(|p| p.map(|c| c as f64));
            let [k, l, m] = floats.map(lift);
            let value = Estimate::orient3d(floats).value;
            (value, volume(points[0], points[1], points[2]), ORIENT3D_SQUARED_BOUND * (k * l * m) + TINY)
        };
        let share = worst(orient3d, 200_000);
        assert!((0.05..0.7).contains(&share), "{share}");
        let insphere = |random: &mut Random| {
            let first = integer_point(random, 23, [0; 3]);
            let [a, b, c, d] = [(); 4].map(|()| integer_point(random, 23, first));
            let exact = square(a) * volume(b, c, d) - square(b) * volume(a, c, d)
                + square(c) * volume(a, b, d)
                - square(d) * volume(a, b, c);
            let floats = [a, b, c, d].map(|p| p.map(|c| c as f64));
            let m = floats.map(lift).into_iter().fold(0.0, f64::max);
            (Estimate::insphere(floats).value, exact, INSPHERE_SQUARED_BOUND * m.powi(5) + TINY)
        };
        let share = worst(insphere, 200_000);
        assert!((0.01..0.7).contains(&share), "{share}");
    }

    /// A corner of a box turned in space and moved off the origin: cospherical with others up to rounding.
    fn on_a_sphere(random: &mut Random, frame: &[Point3; 4]) -> Point3 {
        let signs = [(); 3].map(|()| if random.bits().is_multiple_of(2) { 1.0 } else { -1.0 });
        std::array::from_fn(|axis| {
            let corner: f64 = (0..3).map(|i| frame[i][axis] * signs[i]).sum();
            frame[3][axis] + corner + random.unit() * 1e-15 * frame[3][axis]
        })
    }

    #[test]
    fn what_is_certain_near_degeneracy_has_the_exact_sign() {
        let mut random = Random(2);
        let [mut certain, mut uncertain] = [[0; 2]; 2];
        for case in 0..20_000 {
            // Orders of magnitude from what underflows to what overflows.
            let scale = 2f64.powi(if case % 2 == 0 { 0 } else { (random.bits() % 800) as i32 - 400 });
            let aside = 2f64.powi((random.bits() % 60) as i32 - 30);
            let frame =
                [scale, scale, scale, scale * aside].map(|size| [(); 3].map(|()| random.unit() * size));
            let [a, b, c, d, e] = [(); 5].map(|()| on_a_sphere(&mut random, &frame));
            let [p, q, r, s] = [a, b, c, d].map(|point| difference(point, e));
            let [k, l, m, n] = [p, q, r, s].map(lift);
            let greatest = k.max(l).max(m).max(n);
            let mut check = |kind: usize, is_certain: bool, value: f64, exact: Sign| {
                let counted = if is_certain { &mut certain } else { &mut uncertain };
                counted[kind] += 1;
                assert!(!is_certain || Sign::of(value) == exact, "{:?}", [a, b, c, d, e]);
            };
            let value = Estimate::insphere([p, q, r, s]).value;
            check(
                0,
                insphere_is_certain(value, greatest),
                value,
                big::sign::<Insphere, 4, 3>(e, [a, b, c, d]),
            );
            let value = Estimate::orient3d([p, q, r]).value;
            let exact = big::sign::<Orient3d, 3, 3>(e, [a, b, c]);
            check(1, orient3d_is_certain(value, greatest * greatest * greatest), value, exact);
            // The domain of different squares.
            if scale > 1e-30 && scale < 1e30 {
                check(1, orient3d_is_certain(value, k * l * m), value, exact);
            }
        }
        assert!(certain.iter().chain(&uncertain).all(|&count| count > 1_000), "{certain:?} {uncertain:?}");
    }

    #[test]
    fn neither_infinities_nor_nans_are_certain() {
        for bad in [f64::INFINITY, f64::NAN] {
            assert!(!insphere_is_certain(1e300, bad) && !orient3d_is_certain(1e300, bad));
            assert!(!insphere_is_certain(bad, 1e200) && !orient3d_is_certain(f64::NAN, 1e200));
        }
        assert!(!insphere_is_certain(0.0, 0.0) && !orient3d_is_certain(0.0, 0.0));
    }
}

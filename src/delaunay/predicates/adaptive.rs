//! Predicates of floating-point coordinates: a filter, then [exact] arithmetic.
//!
//! The filters are Shewchuk's ("Adaptive precision floating-point arithmetic and fast robust geometric
//! predicates", 1997, bounds A): with u = 2^-53 the rounded determinant differs from the exact one by at most
//! (3 + 16 u) u S for `orient2d` and (10 + 96 u) u P for `incircle`, where S and P are the same sums with
//! every product replaced by its magnitude, provided that nothing over- or underflows.

use super::forms::{Incircle, Orient2d};
use super::{Extent, Numbers, Point2, PredicateCounts, Predicates2, Sign, exact};

pub(super) const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;
const ORIENT2D_BOUND: f64 = (3.0 + 16.0 * UNIT_ROUNDOFF) * UNIT_ROUNDOFF;
pub(crate) const INCIRCLE_BOUND: f64 = (10.0 + 96.0 * UNIT_ROUNDOFF) * UNIT_ROUNDOFF;

/// A determinant evaluated in `f64`, with the sum of the magnitudes of its products.
pub(crate) struct Estimate {
    pub(crate) value: f64,
    pub(crate) magnitude: f64,
    pub(crate) bound: f64,
}

impl Estimate {
    /// The sign is that of the exact determinant.
    #[inline(always)]
    pub(super) fn is_certain(&self) -> bool {
        self.value.abs() > self.bound * self.magnitude
    }

    /// Orientation from the differences to c.
    #[inline(always)]
    pub(super) fn orient2d([acx, acy]: Point2, [bcx, bcy]: Point2) -> Estimate {
        let (left, right) = (acx * bcy, acy * bcx);
        Estimate { value: left - right, magnitude: left.abs() + right.abs(), bound: ORIENT2D_BOUND }
    }

    /// In-circle determinant from the differences to d.
    #[inline(always)]
    pub(super) fn incircle([adx, ady]: Point2, [bdx, bdy]: Point2, [cdx, cdy]: Point2) -> Estimate {
        let (bc, cb) = (bdx * cdy, cdx * bdy);
        let (ca, ac) = (cdx * ady, adx * cdy);
        let (ab, ba) = (adx * bdy, bdx * ady);
        let a_lift = adx * adx + ady * ady;
        let b_lift = bdx * bdx + bdy * bdy;
        let c_lift = cdx * cdx + cdy * cdy;
        Estimate {
            value: a_lift * (bc - cb) + b_lift * (ca - ac) + c_lift * (ab - ba),
            magnitude: a_lift * (bc.abs() + cb.abs())
                + b_lift * (ca.abs() + ac.abs())
                + c_lift * (ab.abs() + ba.abs()),
            bound: INCIRCLE_BOUND,
        }
    }
}

/// Difference of two points, rounded.
#[inline(always)]
pub(super) fn difference<const D: usize>(p: [f64; D], q: [f64; D]) -> [f64; D] {
    std::array::from_fn(|axis| p[axis] - q[axis])
}

/// Filter, then exact arithmetic that starts with pairs of `f64`.
///
/// Domain: every coordinate is zero or its magnitude lies in [2^-170, 2^240]. Why this suffices:
///
/// * Underflow. All coordinates are multiples of g = 2^-222, the unit in the last place of 2^-170; so are
///   their differences and the rounding errors of these. Every product that is formed has at most four such
///   factors, so it and its rounding error are multiples of g^4 = 2^-888, which is above the least subnormal
///   2^-1074. The sum of magnitudes is zero (and with it the exact determinant, as a difference rounds to zero
///   only if it is zero) or at least 2^-888, so that the smallest error bound formed from it, with a factor of
///   2^-98, is a normal number.
/// * Overflow. Differences are below 2^241, sums of magnitudes below 12 * 2^964 < 2^968; splitting a factor
///   multiplies it by 2^27 + 1, and the result stays below 2^996.
#[derive(Debug, Clone, Default)]
pub struct BoundedFloatPredicates {
    counts: PredicateCounts,
}

impl BoundedFloatPredicates {
    /// Least magnitude of a coordinate other than zero: 2^-170.
    pub const LEAST_MAGNITUDE: f64 = f64::from_bits((1023 - 170) << 52);
    /// Greatest magnitude of a coordinate: 2^240.
    pub const GREATEST_MAGNITUDE: f64 = f64::from_bits((1023 + 240) << 52);

    /// Whether all points within `extent` are in the domain.
    pub fn covers(extent: &Extent) -> bool {
        extent.least_magnitude >= Self::LEAST_MAGNITUDE
            && extent.greatest_magnitude() <= Self::GREATEST_MAGNITUDE
    }

    pub(super) fn covers_point(point: &Point2) -> bool {
        point.iter().all(|coordinate| {
            *coordinate == 0.0
                || (Self::LEAST_MAGNITUDE..=Self::GREATEST_MAGNITUDE).contains(&coordinate.abs())
        })
    }
}

impl Predicates2 for BoundedFloatPredicates {
    const NUMBERS: Numbers = Numbers::BoundedFloats;

    #[inline(always)]
    fn orient2d(&mut self, a: Point2, b: Point2, c: Point2) -> Sign {
        let estimate = Estimate::orient2d(difference(a, c), difference(b, c));
        if estimate.is_certain() {
            self.counts.filter += 1;
            Sign::of(estimate.value)
        } else {
            exact::sign::<Orient2d, 2, 2>(c, [a, b], true, &mut self.counts)
        }
    }

    #[inline(always)]
    fn incircle(&mut self, a: Point2, b: Point2, c: Point2, d: Point2) -> Sign {
        let estimate = Estimate::incircle(difference(a, d), difference(b, d), difference(c, d));
        if estimate.is_certain() {
            self.counts.filter += 1;
            Sign::of(estimate.value)
        } else {
            exact::sign::<Incircle, 3, 2>(d, [a, b, c], true, &mut self.counts)
        }
    }

    counting!();
}

/// Predicates that are right for all finite coordinates, from 5e-324 to 1.7e308, with no look at a chunk
/// first.
///
/// The filter is trusted if each difference is zero or has a magnitude in [2^-200, 2^240]: a product of two
/// is then at least 2^-400, a difference of two such products zero or at least 2^-504, and its product with a
/// lift at least 2^-904; the largest sum is below 2^968. Pairs of `f64` are used in the domain of
/// [`BoundedFloatPredicates`].
#[derive(Debug, Clone, Default)]
pub struct FiniteFloatPredicates {
    counts: PredicateCounts,
}

impl FiniteFloatPredicates {
    const LEAST_DIFFERENCE: f64 = f64::from_bits((1023 - 200) << 52);
    const GREATEST_DIFFERENCE: f64 = f64::from_bits((1023 + 240) << 52);

    pub(super) fn trusts<const D: usize>(difference: &[f64; D]) -> bool {
        difference.iter().all(|value| {
            *value == 0.0 || (Self::LEAST_DIFFERENCE..=Self::GREATEST_DIFFERENCE).contains(&value.abs())
        })
    }
}

impl Predicates2 for FiniteFloatPredicates {
    const NUMBERS: Numbers = Numbers::FiniteFloats;

    fn orient2d(&mut self, a: Point2, b: Point2, c: Point2) -> Sign {
        let differences = [difference(a, c), difference(b, c)];
        let estimate = Estimate::orient2d(differences[0], differences[1]);
        if differences.iter().all(Self::trusts) && estimate.is_certain() {
            self.counts.filter += 1;
            Sign::of(estimate.value)
        } else {
            let is_bounded = [a, b, c].iter().all(BoundedFloatPredicates::covers_point);
            exact::sign::<Orient2d, 2, 2>(c, [a, b], is_bounded, &mut self.counts)
        }
    }

    fn incircle(&mut self, a: Point2, b: Point2, c: Point2, d: Point2) -> Sign {
        let differences = [difference(a, d), difference(b, d), difference(c, d)];
        let estimate = Estimate::incircle(differences[0], differences[1], differences[2]);
        if differences.iter().all(Self::trusts) && estimate.is_certain() {
            self.counts.filter += 1;
            Sign::of(estimate.value)
        } else {
            let is_bounded = [a, b, c, d].iter().all(BoundedFloatPredicates::covers_point);
            exact::sign::<Incircle, 3, 2>(d, [a, b, c], is_bounded, &mut self.counts)
        }
    }

    counting!();
}

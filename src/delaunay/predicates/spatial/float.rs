//! Predicates of floating-point coordinates: a filter, then [exact] arithmetic.

use super::filter::{insphere_is_certain, lift, orient3d_is_certain};
use super::{Extent, Numbers, Point3, PredicateCounts, Predicates3, Sign};
use crate::predicates::adaptive::{Estimate, difference};
use crate::predicates::exact;
use crate::predicates::forms::{Insphere, Orient3d};

/// Differences of b, c, d to a.
#[inline(always)]
pub(super) fn differences_from<const N: usize>(a: Point3, others: [Point3; N]) -> [Point3; N] {
    others.map(|point| difference(point, a))
}

/// Filter, then exact arithmetic that starts with pairs of `f64`.
///
/// Domain: every coordinate is zero or its magnitude lies in [2^-132, 2^200]. Why this suffices:
///
/// * Underflow. All coordinates are multiples of g = 2^-184, the unit in the last place of 2^-132; so are
///   their differences and the rounding errors of these. Every product that is formed has at most five such
///   factors, so it and its rounding error are multiples of g^5 = 2^-920, which is above the least subnormal
///   2^-1074. The sum of magnitudes is zero (and with it the exact determinant, as a difference rounds to zero
///   only if it is zero) or at least 2^-920, so that the smallest error bound formed from it, with a factor of
///   2^-98, is a normal number.
/// * Overflow. Differences are below 2^201. The sum of magnitudes of `insphere` is at most 4 * 3 * 6 = 72
///   products of five of them, below 2^1012. Only differences and sums of products of at most three are split,
///   which multiplies them by 2^27 + 1: the results stay below 2^640.
#[derive(Debug, Clone, Default)]
pub struct BoundedFloatPredicates3 {
    counts: PredicateCounts,
}

impl BoundedFloatPredicates3 {
    /// Least magnitude of a coordinate other than zero: 2^-132.
    pub const LEAST_MAGNITUDE: f64 = f64::from_bits((1023 - 132) << 52);
    /// Greatest magnitude of a coordinate: 2^200.
    pub const GREATEST_MAGNITUDE: f64 = f64::from_bits((1023 + 200) << 52);

    /// Whether all points within `extent` are in the domain.
    pub fn covers(extent: &Extent<3>) -> bool {
        extent.least_magnitude >= Self::LEAST_MAGNITUDE
            && extent.greatest_magnitude() <= Self::GREATEST_MAGNITUDE
    }

    pub(crate) fn covers_point(point: &Point3) -> bool {
        point.iter().all(|coordinate| {
            *coordinate == 0.0
                || (Self::LEAST_MAGNITUDE..=Self::GREATEST_MAGNITUDE).contains(&coordinate.abs())
        })
    }
}

impl Predicates3 for BoundedFloatPredicates3 {
    const NUMBERS: Numbers = Numbers::BoundedFloats;

    #[inline(always)]
    fn orient3d(&mut self, a: Point3, b: Point3, c: Point3, d: Point3) -> Sign {
        let estimate = Estimate::orient3d(differences_from(a, [b, c, d]));
        if estimate.is_certain() {
            self.counts.filter += 1;
            Sign::of(estimate.value)
        } else {
            exact::sign::<Orient3d, 3, 3>(a, [b, c, d], true, &mut self.counts)
        }
    }

    #[inline(always)]
    fn insphere(&mut self, a: Point3, b: Point3, c: Point3, d: Point3, e: Point3) -> Sign {
        let estimate = Estimate::insphere(differences_from(e, [a, b, c, d]));
        if estimate.is_certain() {
            self.counts.filter += 1;
            Sign::of(estimate.value)
        } else {
            exact::sign::<Insphere, 4, 3>(e, [a, b, c, d], true, &mut self.counts)
        }
    }

    counting!();
}

/// Predicates that are right for all finite coordinates, from 5e-324 to 1.7e308, with no look at a chunk
/// first.
///
/// The filters are those in terms of lengths, which hold for all of them. Pairs of `f64` are used in the
/// domain of [`BoundedFloatPredicates3`].
#[derive(Debug, Clone, Default)]
pub struct FiniteFloatPredicates3 {
    counts: PredicateCounts,
}

fn greatest_lift(differences: &[Point3]) -> f64 {
    differences.iter().fold(0.0, |greatest, &difference| lift(difference).max(greatest))
}

impl Predicates3 for FiniteFloatPredicates3 {
    const NUMBERS: Numbers = Numbers::FiniteFloats;

    fn orient3d(&mut self, a: Point3, b: Point3, c: Point3, d: Point3) -> Sign {
        let differences = differences_from(a, [b, c, d]);
        let value = Estimate::orient3d(differences).value;
        let lift = greatest_lift(&differences);
        if orient3d_is_certain(value, lift * lift * lift) {
            self.counts.filter += 1;
            Sign::of(value)
        } else {
            let is_bounded = [a, b, c, d].iter().all(BoundedFloatPredicates3::covers_point);
            exact::sign::<Orient3d, 3, 3>(a, [b, c, d], is_bounded, &mut self.counts)
        }
    }

    fn insphere(&mut self, a: Point3, b: Point3, c: Point3, d: Point3, e: Point3) -> Sign {
        let differences = differences_from(e, [a, b, c, d]);
        let value = Estimate::insphere(differences).value;
        if insphere_is_certain(value, greatest_lift(&differences)) {
            self.counts.filter += 1;
            Sign::of(value)
        } else {
            let is_bounded = [a, b, c, d, e].iter().all(BoundedFloatPredicates3::covers_point);
            exact::sign::<Insphere, 4, 3>(e, [a, b, c, d], is_bounded, &mut self.counts)
        }
    }

    counting!();
}

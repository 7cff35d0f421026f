//! Predicates of integer coordinates, in the narrowest arithmetic that is exact for the chunk.
//!
//! Bounds. Let D be the greatest difference of two coordinates of an axis; all arguments are differences.
//!
//! * `orient2d` is a difference of two products: every intermediate is at most 2 D^2.
//! * `incircle` is a sum of three products of a lift (at most 2 D^2) and a cross product (at most 2 D^2):
//!   every intermediate is at most 12 D^4.
//!
//! Up to D = 2^41 the differences themselves are exact in `f64`: the difference of two integers is an
//! integer, and below 2^53 it is representable, so the rounded difference is the exact one.

use super::adaptive::{Estimate, difference};
use super::{Numbers, Point2, PredicateCounts, Predicates2, Sign};
use std::marker::PhantomData;

/// Above this, integers are not all representable in `f64`: 2^53.
pub(super) const EXACT_F64: f64 = 9_007_199_254_740_992.0;

/// Plain `f64`, no error bound.
///
/// Domain: integers with differences of at most 5,234, since 12 * 5,234^4 = 9,005,671,875,594,432 <= 2^53.
#[derive(Debug, Clone, Default)]
pub struct SmallIntegerPredicates {
    counts: PredicateCounts,
}

impl SmallIntegerPredicates {
    /// Greatest difference of coordinates in the domain.
    pub const MAX_DIFFERENCE: f64 = 5_234.0;
}

impl Predicates2 for SmallIntegerPredicates {
    const NUMBERS: Numbers = Numbers::Integers;

    #[inline(always)]
    fn orient2d(&mut self, a: Point2, b: Point2, c: Point2) -> Sign {
        self.counts.integer += 1;
        Sign::of(Estimate::orient2d(difference(a, c), difference(b, c)).value)
    }

    #[inline(always)]
    fn incircle(&mut self, a: Point2, b: Point2, c: Point2, d: Point2) -> Sign {
        self.counts.integer += 1;
        Sign::of(Estimate::incircle(difference(a, d), difference(b, d), difference(c, d)).value)
    }

    counting!();
}

/// Integers of a fixed width, exact for differences of coordinates up to a limit.
pub trait Width: Default {
    /// Greatest difference of coordinates in the domain.
    const MAX_DIFFERENCE: f64;
    /// Orientation from the differences to c.
    fn orient2d(ac: Point2, bc: Point2) -> Sign;
    /// In-circle sign from the differences to d.
    fn incircle(ad: Point2, bd: Point2, cd: Point2) -> Sign;
}

/// `i64`. Domain: differences of at most 29,609, since 12 * 29,609^4 < 2^63.
#[derive(Debug, Clone, Default)]
pub struct Int64;

/// `i128`. Domain: differences of at most 1.9e9, since 12 * (1.9e9)^4 < 1.57e38 < 2^127.
#[derive(Debug, Clone, Default)]
pub struct Int128;

/// Two `i128`. Domain: differences of at most 2^41 (the full range of an `i32` is below 2^32).
///
/// A lift is at most 2^83. Written as `high * 2^42 + low` with `low < 2^42` it has `high <= 2^41`; a cross
/// product is at most 2^83; so the sums of three products `high * cross` and `low * cross` stay below 3 *
/// 2^125 < 2^127.
#[derive(Debug, Clone, Default)]
pub struct IntPair;

macro_rules! native_width {
    ($width:ty, $integer:ty, $max_difference:expr) => {
        impl Width for $width {
            const MAX_DIFFERENCE: f64 = $max_difference;

            fn orient2d(ac: Point2, bc: Point2) -> Sign {
                let ([acx, acy], [bcx, bcy]) = (ac.map(|v| v as $integer), bc.map(|v| v as $integer));
                Sign::of(acx * bcy - acy * bcx)
            }

            fn incircle(ad: Point2, bd: Point2, cd: Point2) -> Sign {
                let [[adx, ady], [bdx, bdy], [cdx, cdy]] = [ad, bd, cd].map(|p| p.map(|v| v as $integer));
                Sign::of(
                    (adx * adx + ady * ady) * (bdx * cdy - cdx * bdy)
                        + (bdx * bdx + bdy * bdy) * (cdx * ady - adx * cdy)
                        + (cdx * cdx + cdy * cdy) * (adx * bdy - bdx * ady),
                )
            }
        }
    };
}

native_width!(Int64, i64, 29_609.0);
native_width!(Int128, i128, 1.9e9);

impl Width for IntPair {
    const MAX_DIFFERENCE: f64 = 2_199_023_255_552.0;

    fn orient2d(ac: Point2, bc: Point2) -> Sign {
        Int128::orient2d(ac, bc)
    }

    fn incircle(ad: Point2, bd: Point2, cd: Point2) -> Sign {
        const LOW_BITS: u32 = 42;
        let [a, b, c] = [ad, bd, cd].map(|p| p.map(|v| v as i128));
        let (mut high, mut low) = (0, 0);
        for (p, q, r) in [(a, b, c), (b, c, a), (c, a, b)] {
            let lift = p[0] * p[0] + p[1] * p[1];
            let cross = q[0] * r[1] - q[1] * r[0];
            high += (lift >> LOW_BITS) * cross;
            low += (lift & ((1 << LOW_BITS) - 1)) * cross;
        }
        // The carry leaves 0 <= low < 2^42, so that low decides only if high is zero.
        high += low >> LOW_BITS;
        low &= (1 << LOW_BITS) - 1;
        Sign::of(if high == 0 { low } else { high })
    }
}

/// Filter in `f64`, then integers of the given width.
///
/// The sum of magnitudes that the filter needs anyway is a sum of non-negative integers; if it comes out
/// below 2^53 no intermediate of it, and so none of the determinant, was rounded: the value is exact, zero
/// included. This decides nearly all tests between neighbours, however wide the chunk is.
#[derive(Debug, Clone, Default)]
pub struct IntegerPredicates<W> {
    counts: PredicateCounts,
    width: PhantomData<W>,
}

impl<W: Width> IntegerPredicates<W> {
    #[inline(always)]
    fn decide(&mut self, estimate: Estimate, exact: impl FnOnce() -> Sign) -> Sign {
        if estimate.is_certain() {
            self.counts.filter += 1;
            Sign::of(estimate.value)
        } else {
            self.counts.integer += 1;
            if estimate.magnitude < EXACT_F64 { Sign::of(estimate.value) } else { exact() }
        }
    }
}

impl<W: Width> Predicates2 for IntegerPredicates<W> {
    const NUMBERS: Numbers = Numbers::Integers;

    #[inline(always)]
    fn orient2d(&mut self, a: Point2, b: Point2, c: Point2) -> Sign {
        let (ac, bc) = (difference(a, c), difference(b, c));
        self.decide(Estimate::orient2d(ac, bc), || W::orient2d(ac, bc))
    }

    #[inline(always)]
    fn incircle(&mut self, a: Point2, b: Point2, c: Point2, d: Point2) -> Sign {
        let (ad, bd, cd) = (difference(a, d), difference(b, d), difference(c, d));
        self.decide(Estimate::incircle(ad, bd, cd), || W::incircle(ad, bd, cd))
    }

    counting!();
}

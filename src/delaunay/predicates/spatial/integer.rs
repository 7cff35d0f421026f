//! Predicates of integer coordinates, in the narrowest arithmetic that is exact for the chunk.
//!
//! Bounds. Let D be the greatest difference of two coordinates of an axis, so that all points lie in a cube
//! of side D. The magnitude of a determinant of differences to one of the points is convex in every point, so
//! it is greatest with all points in corners:
//!
//! * A 2 by 2 minor is twice the area of a triangle in a square: at most D^2.
//! * `orient3d` is six times the volume of a tetrahedron in the cube: at most 2 D^3. On the way, it is a sum
//!   of three products of a minor and a difference, each at most D^3: at most 3 D^3.
//! * `insphere` is a sum of four products of a square (at most 3 D^2) and an `orient3d` (at most 2 D^3):
//!   every intermediate is at most 24 D^5.
//!
//! The differences themselves are exact in `f64`: the difference of two integers is an integer, and below
//! 2^53 it is representable, so the rounded difference is the exact one.

use super::float::differences_from;
use super::{Int64, Int128, Numbers, Point3, PredicateCounts, Predicates3, Sign};
use crate::predicates::adaptive::Estimate;
use crate::predicates::integer::EXACT_F64;
use std::marker::PhantomData;

/// Plain `f64`, no error bound.
///
/// Domain: integers with differences of at most 822, since 24 * 822^5 = 9,006,796,065,063,168 <= 2^53.
#[derive(Debug, Clone, Default)]
pub struct SmallIntegerPredicates3 {
    counts: PredicateCounts,
}

impl SmallIntegerPredicates3 {
    /// Greatest difference of two coordinates of an axis in the domain.
    pub const MAX_SIDE: f64 = 822.0;
}

impl Predicates3 for SmallIntegerPredicates3 {
    const NUMBERS: Numbers = Numbers::Integers;

    #[inline(always)]
    fn orient3d(&mut self, a: Point3, b: Point3, c: Point3, d: Point3) -> Sign {
        self.counts.integer += 1;
        Sign::of(Estimate::orient3d(differences_from(a, [b, c, d])).value)
    }

    #[inline(always)]
    fn insphere(&mut self, a: Point3, b: Point3, c: Point3, d: Point3, e: Point3) -> Sign {
        self.counts.integer += 1;
        Sign::of(Estimate::insphere(differences_from(e, [a, b, c, d])).value)
    }

    counting!();
}

/// Integers of a fixed width, exact in space for differences of coordinates up to a limit.
pub trait Width3: Default {
    /// Greatest difference of two coordinates of an axis in the domain.
    const MAX_SIDE: f64;
    /// Orientation from the differences of b, c, d to a.
    fn orient3d(differences: [Point3; 3]) -> Sign;
    /// In-sphere sign from the differences of a, b, c, d to e.
    fn insphere(differences: [Point3; 4]) -> Sign;
}

/// Squares and minors, at most 3 D^2, in one type; determinants and what is made of them in another.
macro_rules! native_width {
    ($width:ty, $minor:ty, $determinant:ty, $max_side:expr) => {
        impl Width3 for $width {
            const MAX_SIDE: f64 = $max_side;

            fn orient3d(differences: [Point3; 3]) -> Sign {
                let [p, q, r] = differences.map(|d| d.map(|v| v as $minor));
                Sign::of(<$width>::dot(<$width>::cross(p, q), r))
            }

            fn insphere(differences: [Point3; 4]) -> Sign {
                let [a, b, c, d] = differences.map(|d| d.map(|v| v as $minor));
                let [k, l, m, n] = [a, b, c, d].map(|p| p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
                let (ab, cd) = (<$width>::cross(a, b), <$width>::cross(c, d));
                let product = |lift, cross, r| <$determinant>::from(lift) * <$width>::dot(cross, r);
                Sign::of(product(k, cd, b) - product(l, cd, a) + product(m, ab, d) - product(n, ab, c))
            }
        }

        impl $width {
            fn cross(p: [$minor; 3], q: [$minor; 3]) -> [$minor; 3] {
                [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
            }

            fn dot(p: [$minor; 3], q: [$minor; 3]) -> $determinant {
                let product = |i: usize| <$determinant>::from(p[i]) * <$determinant>::from(q[i]);
                product(0) + product(1) + product(2)
            }
        }
    };
}

// 24 * 3,288^5 = 9,222,959,170,624,684,032 < 2^63.
native_width!(Int64, i64, i64, 3_288.0);
// 24 * (2.34e7)^5 < 1.684e38 < 2^127, and 3 * (2.34e7)^2 < 2^51.
native_width!(Int128, i64, i128, 2.34e7);

/// Filter in `f64`, then integers of the given width.
///
/// The sum of magnitudes that the filter needs anyway is a sum of products of non-negative integers; if it
/// comes out below 2^53 no intermediate of it was rounded, but for factors of zero, and so none of the
/// determinant: the value is exact, zero included.
#[derive(Debug, Clone, Default)]
pub struct IntegerPredicates3<W> {
    counts: PredicateCounts,
    width: PhantomData<W>,
}

impl<W: Width3> IntegerPredicates3<W> {
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

impl<W: Width3> Predicates3 for IntegerPredicates3<W> {
    const NUMBERS: Numbers = Numbers::Integers;

    #[inline(always)]
    fn orient3d(&mut self, a: Point3, b: Point3, c: Point3, d: Point3) -> Sign {
        let differences = differences_from(a, [b, c, d]);
        self.decide(Estimate::orient3d(differences), || W::orient3d(differences))
    }

    #[inline(always)]
    fn insphere(&mut self, a: Point3, b: Point3, c: Point3, d: Point3, e: Point3) -> Sign {
        let differences = differences_from(e, [a, b, c, d]);
        self.decide(Estimate::insphere(differences), || W::insphere(differences))
    }

    counting!();
}

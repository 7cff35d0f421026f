//! Exact signs, where rounded values do not tell.

use super::determinant::{Number, difference, dot, lift, normal, sphere};
use crate::predicates::exact_integers::integers;
use num_bigint::BigInt;
use spmesh_model::cells4::Point4;
use std::cmp::Ordering;
use std::num::Wrapping;

/// How the sign of a value is found that is near zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Exactness {
    /// The value is exact as it is, and coefficients of spheres have 32 bits: coordinates are very small
    /// integers.
    Small,
    /// The value is exact as it is: coordinates are small integers.
    Double,
    /// In integers of 128 bits.
    Int128,
    /// In integers of any size.
    Big,
}

impl Exactness {
    /// Whether values in `f64` have no rounding error.
    pub(super) fn is_double(self) -> bool {
        matches!(self, Exactness::Small | Exactness::Double)
    }
}

/// Greatest difference of integer coordinates with which coefficients of spheres have 32 bits.
///
/// With differences up to E, coordinates are at most H = E/2, rounded up, about the centre of the box, and
/// their lifts 4 H^2. A coefficient of a coordinate is a sum of five lifts, each times a determinant of four
/// points in a box of 3 dimensions, at most 2 E^3; the constant one of five lifts, each times a determinant
/// of four vectors of length at most 2 H, at most 16 H^4: 320 H^6, which is 1.6e9 here. The determinant of a
/// simplex is at most 3 E^4.
pub(super) const SMALL_MAX: f64 = 26.0;

/// Greatest difference of integer coordinates with which in-sphere values are exact in `f64`, in whatever
/// order they are added up.
///
/// With differences up to E, and coordinates up to E/2 + 1 about the centre of the box, no sum of magnitudes
/// of terms exceeds 280 E^6 for E above 30; here that is 6.8e15, below 2^53.
pub(super) const DOUBLE_MAX: f64 = 170.0;

/// The same for integers of 128 bits.
///
/// The value is a sum of five lifts of at most 4 E^2, each times the determinant of a simplex within the box,
/// which is at most 3 E^4 (Hadamard's bound for 5 points of a cube): 60 E^6 < 2^127. Sums on the way may
/// wrap: only the result counts.
pub(super) const INT128_MAX: f64 = 1_180_000.0;

/// The sign of the in-sphere value of a point: `Less` inside of the sphere of a positive simplex.
pub(super) fn in_sphere(exactness: Exactness, simplex: [Point4; 5], point: Point4) -> Ordering {
    fn value<T: Number>([o, a, b, c, d, p]: [[T; 4]; 6]) -> T {
        let from = |q: [T; 4]| difference(q, &o);
        let p = from(p);
        let (n, m) = sphere([from(a), from(b), from(c), from(d)]);
        dot(&n, &p) + m * lift(&p)
    }
    let [o, a, b, c, d] = simplex;
    let points = [o, a, b, c, d, point];
    match exactness {
        Exactness::Big => value(integers(points)).cmp(&BigInt::ZERO),
        _ => value(points.map(wrapping)).0.cmp(&0),
    }
}

/// The sign of the determinant of (b - a, c - a, d - a, p - a).
pub(super) fn orientation(exactness: Exactness, [a, b, c, d]: [Point4; 4], point: Point4) -> Ordering {
    fn value<T: Number>([a, b, c, d, p]: [[T; 4]; 5]) -> T {
        let from = |q: [T; 4]| difference(q, &a);
        dot(&normal([from(b), from(c), from(d)]), &from(p))
    }
    let points = [a, b, c, d, point];
    match exactness {
        Exactness::Big => value(integers(points)).cmp(&BigInt::ZERO),
        _ => value(points.map(wrapping)).0.cmp(&0),
    }
}

fn wrapping(p: Point4) -> [Wrapping<i128>; 4] {
    p.map(|x| Wrapping(x as i128))
}

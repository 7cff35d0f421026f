//! Exact signs, for rounded values near zero.

use super::determinant::{Magnitude, Number, difference, dot, lift, lifted_sphere, normal};
use spmesh_delaunay::predicates::forms::Form;
use spmesh_delaunay::predicates::{PredicateCounts, Sign, exact};
use spmesh_stream::model::cells4::Point4;
use std::cmp::Ordering;
use std::num::Wrapping;

/// How the sign of a value near zero is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Exactness {
    /// `f64` is exact, and coefficients of spheres fit 32 bits: coordinates are very small integers.
    Small,
    /// `f64` is exact: coordinates are small integers.
    Double,
    /// In 128-bit integers.
    Int128,
    /// In pairs of `f64`, residues, or big integers.
    Big,
}

impl Exactness {
    /// Whether values in `f64` are free of rounding error.
    pub(super) fn is_double(self) -> bool {
        matches!(self, Exactness::Small | Exactness::Double)
    }
}

/// Greatest difference of integer coordinates for which coefficients of spheres fit 32 bits.
///
/// With differences up to E, coordinates are at most H = E/2, rounded up, about the centre of the box, and
/// their lifts 4 H^2. A coefficient of a coordinate is a sum of five lifts, each times a determinant of four
/// points in a box of 3 dimensions, at most 2 E^3; the constant one of five lifts, each times a determinant
/// of four vectors of length at most 2 H, at most 16 H^4: 320 H^6, which is 1.6e9 here. The determinant of a
/// simplex is at most 3 E^4.
pub(super) const SMALL_MAX: f64 = 26.0;

/// Greatest difference of integer coordinates for which in-sphere values are exact in `f64`, whatever the
/// order of summation.
///
/// With differences up to E, and coordinates up to E/2 + 1 about the centre of the box, no sum of magnitudes
/// of terms exceeds 280 E^6 for E above 30; here that is 6.8e15, below 2^53.
pub(super) const DOUBLE_MAX: f64 = 170.0;

/// The same bound for 128-bit integers.
///
/// The value is a sum of five lifts of at most 4 E^2, each times the determinant of a simplex within the box,
/// which is at most 3 E^4 (Hadamard's bound for 5 points of a cube): 60 E^6 < 2^127. Intermediate sums may
/// wrap; only the result must fit.
pub(super) const INT128_MAX: f64 = 1_180_000.0;

/// The sign of the in-sphere value of a point: `Less` inside the sphere of a positive simplex.
pub(super) fn in_sphere(exactness: Exactness, [o, a, b, c, d]: [Point4; 5], point: Point4) -> Ordering {
    sign::<InSphere, 5>(exactness, o, [a, b, c, d, point])
}

/// The sign of the determinant of (b - a, c - a, d - a, p - a).
pub(super) fn orientation(exactness: Exactness, [a, b, c, d]: [Point4; 4], point: Point4) -> Ordering {
    sign::<Orientation, 4>(exactness, a, [b, c, d, point])
}

struct InSphere;

impl Form<5, 4> for InSphere {
    #[inline(always)]
    fn value<T: Number>([a, b, c, d, p]: &[[T; 4]; 5], lift: impl Fn(usize) -> T) -> T {
        let (n, m) = lifted_sphere([(a, lift(0)), (b, lift(1)), (c, lift(2)), (d, lift(3))]);
        dot(&n, p) + m * lift(4)
    }
}

struct Orientation;

impl Form<4, 4> for Orientation {
    #[inline(always)]
    fn value<T: Number>([b, c, d, p]: &[[T; 4]; 4], _: impl Fn(usize) -> T) -> T {
        dot(&normal([b, c, d]), p)
    }
}

fn sign<F: Form<N, 4>, const N: usize>(exactness: Exactness, from: Point4, to: [Point4; N]) -> Ordering {
    if exactness == Exactness::Big {
        return sign_of_floats::<F, N>(from, to).cmp(&Sign::Zero);
    }
    let wrapping = |p: Point4| p.map(|x| Wrapping(x as i128));
    let from = wrapping(from);
    let vectors = to.map(|p| difference(wrapping(p), &from));
    F::value(&vectors, |i| lift(&vectors[i])).0.cmp(&0)
}

/// A value of degree six in rounded differences is off by at most this times the sum of the magnitudes of its
/// products. With u = 2^-53, differences are off by u, lifts by 5 u, minors with a lift by 8 u, coefficients by
/// 16 u, and the value by 21 u; the rest is more than terms of order u^2.
const ERROR: f64 = 12.0 * f64::EPSILON;

#[inline(never)]
fn sign_of_floats<F: Form<N, 4>, const N: usize>(mut from: Point4, mut to: [Point4; N]) -> Sign {
    let is_bounded = is_bounded(&from) && to.iter().all(is_bounded);
    let mut counts = PredicateCounts::default();
    if !is_bounded {
        return exact::sign::<F, N, 4>(from, to, false, &mut counts);
    }
    if let Some(sign) = rounded::<F, N>(&from, &to) {
        return sign;
    }
    let Some(nearest) = nearest_to_all(&from, &to) else {
        return exact::sign::<F, N, 4>(from, to, true, &mut counts);
    };
    std::mem::swap(&mut from, &mut to[nearest]);
    let swapped =
        rounded::<F, N>(&from, &to).unwrap_or_else(|| exact::sign::<F, N, 4>(from, to, true, &mut counts));
    // A determinant changes its sign when two of its points change places.
    swapped.opposite()
}

/// The sign of the value in `f64`, if it is certain.
#[inline(always)]
fn rounded<F: Form<N, 4>, const N: usize>(from: &Point4, to: &[Point4; N]) -> Option<Sign> {
    let mut vectors = [[0.0; 4]; N];
    let mut magnitudes = [[Magnitude(0.0); 4]; N];
    for i in 0..N {
        for axis in 0..4 {
            vectors[i][axis] = to[i][axis] - from[axis];
            magnitudes[i][axis] = Magnitude(vectors[i][axis].abs());
        }
    }
    let value = F::value(&vectors, |i| lift(&vectors[i]));
    let error = ERROR * F::value(&magnitudes, |i| lift(&magnitudes[i])).0;
    (value.abs() > error).then(|| Sign::of(value))
}

/// The point whose distances to the others have the least product, if it is not `from`. Seen from a point far
/// away, all others lie in almost the same direction, and determinants of such rows cancel.
#[cold]
fn nearest_to_all<const N: usize>(from: &Point4, to: &[Point4; N]) -> Option<usize> {
    let distance = |p: &Point4, q: &Point4| {
        let greatest = (0..4).fold(0.0, |greatest: f64, axis| greatest.max((p[axis] - q[axis]).abs()));
        i64::from((greatest.to_bits() >> 52) as u32)
    };
    let product = |p: &Point4| to.iter().chain([from]).map(|q| distance(p, q)).sum::<i64>();
    let (best, nearest) = (0..N).map(|i| (product(&to[i]), i)).min()?;
    (best < product(from)).then_some(nearest)
}

/// Coordinates that are zero or of magnitudes from 2^-100 to 2^100 are multiples of 2^-152, and the products
/// of six of them, with their rounding errors, are multiples of 2^-912: nothing underflows, and nothing
/// overflows.
#[inline(always)]
fn is_bounded(point: &Point4) -> bool {
    const RANGE: std::ops::RangeInclusive<f64> =
        f64::from_bits((1023 - 100) << 52)..=f64::from_bits((1023 + 100) << 52);
    let mut all = true;
    for x in point {
        all &= *x == 0.0 || RANGE.contains(&x.abs());
    }
    all
}

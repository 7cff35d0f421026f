//! Exact signs, for rounded values near zero.

use super::determinant::{Magnitude, Number, difference, dot, lift, normal, sphere};
use crate::predicates::exact_integers::integers_of;
use crate::predicates::pairs::Pair;
#[cfg(target_arch = "x86_64")]
use crate::processor::Avx2Fma;
use num_bigint::BigInt;
use spmesh_model::cells4::Point4;
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
    /// In big integers.
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

/// A value of N vectors from one point to others.
trait Form<const N: usize> {
    fn value<T: Number>(vectors: [[T; 4]; N]) -> T;
}

struct InSphere;

impl Form<5> for InSphere {
    #[inline(always)]
    fn value<T: Number>([a, b, c, d, p]: [[T; 4]; 5]) -> T {
        let (n, m) = sphere([a, b, c, d]);
        dot(&n, &p) + m * lift(&p)
    }
}

struct Orientation;

impl Form<4> for Orientation {
    #[inline(always)]
    fn value<T: Number>([b, c, d, p]: [[T; 4]; 4]) -> T {
        dot(&normal([b, c, d]), &p)
    }
}

fn sign<F: Form<N>, const N: usize>(exactness: Exactness, from: Point4, to: [Point4; N]) -> Ordering {
    if exactness == Exactness::Big {
        return sign_of_pairs::<F, N>(from, to).unwrap_or_else(|| big_sign::<F, N>(from, to));
    }
    let wrapping = |p: Point4| p.map(|x| Wrapping(x as i128));
    let from = wrapping(from);
    F::value(to.map(|p| difference(wrapping(p), &from))).0.cmp(&0)
}

fn big_sign<F: Form<N>, const N: usize>(from: Point4, to: [Point4; N]) -> Ordering {
    let mut points = to.to_vec();
    points.push(from);
    let integers = integers_of(&points);
    let vectors = std::array::from_fn(|i| difference(integers[i].clone(), &integers[N]));
    F::value(vectors).cmp(&BigInt::ZERO)
}

/// The sign found in pairs of `f64`, if it is certain.
fn sign_of_pairs<F: Form<N>, const N: usize>(from: Point4, to: [Point4; N]) -> Option<Ordering> {
    #[cfg(target_arch = "x86_64")]
    if Avx2Fma::detect().is_some() {
        // SAFETY: the processor has AVX2 and FMA.
        return unsafe { sign_of_fused_pairs::<F, N>(from, to) };
    }
    sign_of_pairs_of::<F, N, false>(from, to)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn sign_of_fused_pairs<F: Form<N>, const N: usize>(from: Point4, to: [Point4; N]) -> Option<Ordering> {
    sign_of_pairs_of::<F, N, true>(from, to)
}

/// Coordinates that are zero or of magnitudes from 2^-100 to 2^100 are multiples of 2^-152, and the products
/// of six of them, with their rounding errors, are multiples of 2^-912: nothing underflows, and nothing
/// overflows.
const IN_RANGE: std::ops::RangeInclusive<f64> =
    f64::from_bits((1023 - 100) << 52)..=f64::from_bits((1023 + 100) << 52);

/// The bound of [`Pair`] for values of degree six, in units of the sum of magnitudes. With u = 2^-53,
/// products are off by 9 u^2 and sums by 4 u^2: 21 u^2 for a lift, 34 u^2 for a minor with it, 68 u^2 for a
/// coefficient, 90 u^2 for the value.
const PAIR_BOUND: f64 = 64.0 * f64::EPSILON * f64::EPSILON;

#[inline(always)]
fn sign_of_pairs_of<F: Form<N>, const N: usize, const FUSED: bool>(
    from: Point4,
    to: [Point4; N],
) -> Option<Ordering> {
    let is_in_range = |x: &f64| *x == 0.0 || IN_RANGE.contains(&x.abs());
    if !to.iter().chain([&from]).flatten().all(is_in_range) {
        return None;
    }
    let difference = |p: Point4| -> [Pair<FUSED>; 4] { std::array::from_fn(|i| Pair::sum(p[i], -from[i])) };
    let magnitude =
        |p: Point4| -> [Magnitude; 4] { std::array::from_fn(|i| Magnitude((p[i] - from[i]).abs())) };
    let value = F::value(to.map(difference)).rounded();
    let bound = PAIR_BOUND * F::value(to.map(magnitude)).0;
    (value.abs() > bound).then(|| value.total_cmp(&0.0))
}

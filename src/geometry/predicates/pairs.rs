//! Determinants in double-word arithmetic: a filter between the one in `f64` and full expansions.
//!
//! Input that was rounded after it was turned or put on a circle is nowhere degenerate, but too near to it
//! for `f64`. Pairs of `f64` decide it in a fraction of the time of expansions.
//!
//! # Derivation
//!
//! A [`Pair`] stands for the exact sum of its two numbers; with u = 2^-53, the lower one is at most u times
//! the higher one. Differences of coordinates are exact pairs. Write |x| for the magnitude of the higher
//! number.
//!
//! * *Product* of x and y. The product of the higher numbers is exact. Each of the two mixed products is at
//!   most u |x| |y| and rounded once, so is their sum, and its sum with the lower number of the first
//!   product: at most 8 u^2 |x| |y|. The product of the lower ones, u^2 |x| |y|, is left out: 9 u^2 |x| |y|.
//! * *Sum* of x and y. The sum of the higher numbers is exact. The lower ones are together at most u (|x| +
//!   |y|) and rounded once; their sum with what the first sum has left, 2 u (|x| + |y|), is rounded once: at
//!   most 4 u^2 (|x| + |y|), generously.
//!
//! So each product of a determinant is off by at most 9 u^2 of itself for each multiplication on its way into
//! the sum, and 4 u^2 for each addition, which makes
//!
//! * `orient2d`, 1 product and 1 sum: 13 u^2; `incircle`, a lift (13) times a minor (13), 2 sums: 43 u^2;
//! * `orient3d`, a minor (13) times a difference, 2 sums: 30 u^2; `insphere`, a lift (17) times an `orient3d`
//!   (30), 2 sums: 64 u^2,
//!
//! times the sum of the magnitudes of the products. [`BOUND`] is more than all of them, by far more than what
//! terms of order u^3 and the rounding of that sum add.
//!
//! Domain: that of the expansions. All numbers are then multiples of a power of two so great that no product
//! or error of a product underflows, and nothing overflows when a factor is split.

use super::Sign;
#[cfg(target_arch = "x86_64")]
use crate::processor::Avx2Fma;
use std::ops::{Add, Mul, Sub};

/// The sign is certain if the value is more than this times the sum of magnitudes: 128 u^2.
const BOUND: f64 = 32.0 * f64::EPSILON * f64::EPSILON;

/// Splits a number in two of half the digits (Veltkamp, Dekker 1971).
const SPLITTER: f64 = ((1u64 << 27) + 1) as f64;

/// The exact sum of two numbers, of which the second is at most the rounding error of the first. `FUSED`: the
/// processor multiplies and adds in one instruction, which makes products cheap. The numbers are the same.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pair<const FUSED: bool>(f64, f64);

#[inline(always)]
fn split(a: f64) -> [f64; 2] {
    let c = SPLITTER * a;
    let high = c - (c - a);
    [high, a - high]
}

impl<const FUSED: bool> Pair<FUSED> {
    /// The sum of two numbers and its rounding error (Knuth).
    #[inline(always)]
    pub(crate) fn sum(a: f64, b: f64) -> Self {
        let sum = a + b;
        let b_part = sum - a;
        let a_part = sum - b_part;
        Pair(sum, (a - a_part) + (b - b_part))
    }

    /// The sum, rounded.
    #[inline(always)]
    pub(crate) fn rounded(self) -> f64 {
        self.0
    }

    /// The product of two numbers and its rounding error (Dekker).
    #[inline(always)]
    fn product(a: f64, b: f64) -> Self {
        let product = a * b;
        if FUSED {
            return Pair(product, a.mul_add(b, -product));
        }
        let ([a_high, a_low], [b_high, b_low]) = (split(a), split(b));
        let error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
        Pair(product, error)
    }
}

impl<const FUSED: bool> Add for Pair<FUSED> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let Pair(high, left) = Pair::<FUSED>::sum(self.0, other.0);
        Pair::sum(high, left + (self.1 + other.1))
    }
}

impl<const FUSED: bool> Sub for Pair<FUSED> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + Pair(-other.0, -other.1)
    }
}

impl<const FUSED: bool> Mul for Pair<FUSED> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let Pair(high, low) = Pair::<FUSED>::product(self.0, other.0);
        Pair::sum(high, low + (self.0 * other.1 + self.1 * other.0))
    }
}

/// Differences of two points, exactly.
#[inline(always)]
fn difference<const D: usize, const FUSED: bool>(p: [f64; D], q: [f64; D]) -> [Pair<FUSED>; D] {
    std::array::from_fn(|axis| Pair::sum(p[axis], -q[axis]))
}

/// A determinant, with the sum of the magnitudes of its products.
#[derive(Debug, Clone, Copy)]
struct Determinant<const FUSED: bool> {
    value: Pair<FUSED>,
    magnitude: f64,
}

impl<const FUSED: bool> Determinant<FUSED> {
    /// Of two rows.
    #[inline(always)]
    fn minor(p: [Pair<FUSED>; 2], q: [Pair<FUSED>; 2]) -> Self {
        let magnitude = (p[0].0 * q[1].0).abs() + (p[1].0 * q[0].0).abs();
        Determinant { value: p[0] * q[1] - p[1] * q[0], magnitude }
    }

    #[inline(always)]
    fn times(self, factor: Pair<FUSED>) -> Self {
        Determinant { value: self.value * factor, magnitude: self.magnitude * factor.0.abs() }
    }

    /// The sign, if it is certain. A value of zero never is.
    #[inline(always)]
    fn sign(self) -> Option<Sign> {
        (self.value.0.abs() > BOUND * self.magnitude).then(|| Sign::of(self.value.0))
    }
}

impl<const FUSED: bool> Add for Determinant<FUSED> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Determinant { value: self.value + other.value, magnitude: self.magnitude + other.magnitude }
    }
}

impl<const FUSED: bool> Sub for Determinant<FUSED> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Determinant { value: self.value - other.value, magnitude: self.magnitude + other.magnitude }
    }
}

#[inline(always)]
fn cross<const FUSED: bool>(p: [Pair<FUSED>; 3], q: [Pair<FUSED>; 3]) -> [Determinant<FUSED>; 3] {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| Determinant::minor([p[i], p[j]], [q[i], q[j]]))
}

#[inline(always)]
fn dot<const FUSED: bool>(cross: [Determinant<FUSED>; 3], r: [Pair<FUSED>; 3]) -> Determinant<FUSED> {
    cross[0].times(r[0]) + cross[1].times(r[1]) + cross[2].times(r[2])
}

/// Sign of det(a - c, b - c), if it is certain.
pub(super) fn orient2d(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> Option<Sign> {
    Determinant::<false>::minor(difference(a, c), difference(b, c)).sign()
}

/// Side of d against the circle through a, b, c, if it is certain.
pub(super) fn incircle(a: [f64; 2], b: [f64; 2], c: [f64; 2], d: [f64; 2]) -> Option<Sign> {
    #[cfg(target_arch = "x86_64")]
    if Avx2Fma::detect().is_some() {
        // SAFETY: the processor has AVX2 and FMA.
        return unsafe { incircle_fused([a, b, c], d) };
    }
    incircle_of::<false>([a, b, c], d)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn incircle_fused(circle: [[f64; 2]; 3], d: [f64; 2]) -> Option<Sign> {
    incircle_of::<true>(circle, d)
}

#[inline(always)]
fn incircle_of<const FUSED: bool>([a, b, c]: [[f64; 2]; 3], d: [f64; 2]) -> Option<Sign> {
    let (a, b, c) = (difference::<2, FUSED>(a, d), difference(b, d), difference(c, d));
    let lift = |p: [Pair<FUSED>; 2]| p[0] * p[0] + p[1] * p[1];
    let term = |p, q, r| Determinant::minor(q, r).times(lift(p));
    (term(a, b, c) + term(b, c, a) + term(c, a, b)).sign()
}

/// Sign of det(b - a, c - a, d - a), if it is certain.
pub(super) fn orient3d(a: [f64; 3], b: [f64; 3], c: [f64; 3], d: [f64; 3]) -> Option<Sign> {
    dot::<false>(cross(difference(b, a), difference(c, a)), difference(d, a)).sign()
}

/// Side of e against the sphere through a, b, c, d, if it is certain.
pub(super) fn insphere(a: [f64; 3], b: [f64; 3], c: [f64; 3], d: [f64; 3], e: [f64; 3]) -> Option<Sign> {
    #[cfg(target_arch = "x86_64")]
    if Avx2Fma::detect().is_some() {
        // SAFETY: the processor has AVX2 and FMA.
        return unsafe { insphere_fused([a, b, c, d], e) };
    }
    insphere_of::<false>([a, b, c, d], e)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn insphere_fused(sphere: [[f64; 3]; 4], e: [f64; 3]) -> Option<Sign> {
    insphere_of::<true>(sphere, e)
}

#[inline(always)]
fn insphere_of<const FUSED: bool>([a, b, c, d]: [[f64; 3]; 4], e: [f64; 3]) -> Option<Sign> {
    let (a, b) = (difference::<3, FUSED>(a, e), difference::<3, FUSED>(b, e));
    let (c, d) = (difference::<3, FUSED>(c, e), difference::<3, FUSED>(d, e));
    let (ab, cd) = (cross(a, b), cross(c, d));
    let lift = |p: [Pair<FUSED>; 3]| p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
    let (first, second) = (dot(cd, b).times(lift(a)), dot(cd, a).times(lift(b)));
    let (third, fourth) = (dot(ab, d).times(lift(c)), dot(ab, c).times(lift(d)));
    ((first - second) + (third - fourth)).sign()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::predicates::{Point2, Point3, big};
    use spmesh_core::random::Random;

    fn unit(random: &mut Random) -> f64 {
        random.bits() as f64 / u64::MAX as f64 - 0.5
    }

    fn cross(p: Point3, q: Point3) -> Point3 {
        [(1, 2), (2, 0), (0, 1)].map(|(i, j)| p[i] * q[j] - p[j] * q[i])
    }

    /// The corners of a box, turned unless `is_level`, moved aside and rounded.
    fn corners(random: &mut Random, aside: f64, is_level: bool) -> [Point3; 8] {
        let mut vector = |size: f64| [0, 1, 2].map(|_| size * unit(random));
        let (first, second, middle) = (vector(1.0), vector(1.0), vector(aside));
        let second = cross(first, second);
        let turned = [first, second, cross(first, second)];
        let level = |i: usize| [0, 1, 2].map(|axis| if axis == i { first[i] } else { 0.0 });
        let axes = if is_level { [0, 1, 2].map(level) } else { turned };
        let sign = |code: usize, i: usize| if code >> i & 1 == 1 { 1.0 } else { -1.0 };
        std::array::from_fn(|code| {
            [0, 1, 2].map(|axis| middle[axis] + (0..3).map(|i| sign(code, i) * axes[i][axis]).sum::<f64>())
        })
    }

    /// The corners of a square, likewise.
    fn square(random: &mut Random, aside: f64, is_level: bool) -> [Point2; 4] {
        let [mut x, y, a, b] = [unit(random), unit(random), aside * unit(random), aside * unit(random)];
        if is_level {
            x = y;
        }
        [[x, y], [-y, x], [-x, -y], [y, -x]].map(|[x, y]| [a + x, b + y])
    }

    #[test]
    fn certain_signs_are_exact() {
        let mut random = Random::new(1);
        let (mut certain, mut uncertain) = ([0; 4], [0; 4]);
        let mut check = |kind: usize, sign: Option<Sign>, exact: Sign| match sign {
            Some(sign) => {
                certain[kind] += 1;
                assert_eq!(sign, exact);
            }
            None => uncertain[kind] += 1,
        };
        for case in 0..20_000 {
            let (aside, is_level) = (2f64.powi(case % 60 - 20), case % 4 == 0);
            let p = square(&mut random, aside, is_level);
            check(0, incircle(p[0], p[1], p[2], p[3]), big::incircle(p[0], p[1], p[2], p[3]));
            let middle = [0, 1].map(|axis| p[0][axis].midpoint(p[1][axis]));
            check(1, orient2d(p[0], p[1], middle), big::orient2d(p[0], p[1], middle));
            let p = corners(&mut random, aside, is_level);
            check(2, orient3d(p[0], p[1], p[2], p[3]), big::orient3d(p[0], p[1], p[2], p[3]));
            check(3, insphere(p[0], p[1], p[2], p[4], p[7]), big::insphere(p[0], p[1], p[2], p[4], p[7]));
        }
        assert!(certain.iter().all(|&count| count > 5_000), "{certain:?} {uncertain:?}");
        assert!(uncertain.iter().all(|&count| count > 1_000), "{certain:?} {uncertain:?}");
    }

    #[test]
    fn both_ways_to_multiply_agree() {
        let mut random = Random::new(2);
        for _ in 0..10_000 {
            let (a, b) = (1e100 * unit(&mut random), unit(&mut random));
            let (fused, split) = (Pair::<true>::product(a, b), Pair::<false>::product(a, b));
            assert_eq!((fused.0, fused.1), (split.0, split.1));
        }
    }

    #[test]
    fn zero_is_never_certain() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert_eq!(incircle(square[0], square[1], square[2], square[3]), None);
        assert_eq!(orient2d([0.0, 0.0], [1.0, 3.0], [2.0, 6.0]), None);
        assert_eq!(orient3d([0.0; 3], [1.0; 3], [2.0; 3], [5.0, 7.0, 9.0]), None);
    }
}

//! Determinants in double-word arithmetic: a filter between the one in `f64` and exact arithmetic.
//!
//! Input that was rounded after it was turned or put on a circle is nowhere degenerate, but too near to it
//! for `f64`. Pairs of `f64` decide it in a fraction of a microsecond.
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
//!   (30), 2 sums: 64 u^2;
//! * in four dimensions 21 u^2 for a lift, 34 u^2 for a minor with it, 68 u^2 for a coefficient, 90 u^2 for a
//!   value of degree six,
//!
//! times the sum of the magnitudes of the products. [`BOUND`] is more than all of them, by far more than what
//! terms of order u^3 and the rounding of that sum add.
//!
//! Domain: coordinates in a range that callers of [`sign`] ensure. All numbers are then multiples of a power of
//! two so great that no product or error of a product underflows, and nothing overflows when a factor is
//! split.

use super::Sign;
use super::forms::{Form, Magnitude, lift};
#[cfg(target_arch = "x86_64")]
use crate::processor::Avx2Fma;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The sign is certain if the value is more than this times the sum of magnitudes: 256 u^2.
const BOUND: f64 = 64.0 * f64::EPSILON * f64::EPSILON;

/// Splits a number in two of half the digits (Veltkamp, Dekker 1971).
const SPLITTER: f64 = ((1u64 << 27) + 1) as f64;

/// The exact sum of two numbers, of which the second is at most the rounding error of the first. `FUSED`: the
/// processor multiplies and adds in one instruction, which makes products cheap. The numbers are the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair<const FUSED: bool>(pub f64, pub f64);

#[inline(always)]
fn split(a: f64) -> [f64; 2] {
    let c = SPLITTER * a;
    let high = c - (c - a);
    [high, a - high]
}

impl<const FUSED: bool> Pair<FUSED> {
    /// The sum of two numbers and its rounding error (Knuth).
    #[inline(always)]
    fn sum(a: f64, b: f64) -> Self {
        let sum = a + b;
        let b_part = sum - a;
        let a_part = sum - b_part;
        Pair(sum, (a - a_part) + (b - b_part))
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

impl<const FUSED: bool> Neg for Pair<FUSED> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Pair(-self.0, -self.1)
    }
}

/// A quotient, and the quotient of what it leaves: its relative error is below 16 u^2.
impl<const FUSED: bool> Div for Pair<FUSED> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let quotient = self.0 / other.0;
        let left = self - other * Pair(quotient, 0.0);
        Pair::sum(quotient, left.0 / other.0)
    }
}

/// The nearest pair.
impl<const FUSED: bool> From<i128> for Pair<FUSED> {
    #[inline(always)]
    fn from(value: i128) -> Self {
        if let Ok(short) = i64::try_from(value) {
            let high = short as f64;
            return Pair(high, (short as i128 - high as i128) as f64);
        }
        let high = value as f64;
        Pair(high, value.wrapping_sub(high as i128) as f64)
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

/// The sign of a form of the differences from one point to others, if it is certain, which a value of zero
/// never is; otherwise a number that its magnitude does not exceed.
#[inline(always)]
pub(super) fn sign<F: Form<N, D>, const N: usize, const D: usize>(
    from: [f64; D],
    to: [[f64; D]; N],
) -> Result<Sign, f64> {
    #[cfg(target_arch = "x86_64")]
    if Avx2Fma::detect().is_some() {
        // SAFETY: the processor has AVX2 and FMA.
        return unsafe { sign_fused::<F, N, D>(from, to) };
    }
    sign_of::<F, N, D, false>(from, to)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn sign_fused<F: Form<N, D>, const N: usize, const D: usize>(
    from: [f64; D],
    to: [[f64; D]; N],
) -> Result<Sign, f64> {
    sign_of::<F, N, D, true>(from, to)
}

#[inline(always)]
fn sign_of<F: Form<N, D>, const N: usize, const D: usize, const FUSED: bool>(
    from: [f64; D],
    to: [[f64; D]; N],
) -> Result<Sign, f64> {
    let mut exact = [[Pair::<FUSED>(0.0, 0.0); D]; N];
    let mut rounded = [[Magnitude(0.0); D]; N];
    for i in 0..N {
        for axis in 0..D {
            exact[i][axis] = Pair::sum(to[i][axis], -from[axis]);
            rounded[i][axis] = Magnitude(exact[i][axis].0.abs());
        }
    }
    let value = F::value(&exact, |i| lift(&exact[i])).0;
    let error = BOUND * F::value(&rounded, |i| lift(&rounded[i])).0;
    if value.abs() > error { Ok(Sign::of(value)) } else { Err(2.0 * error) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::predicates::forms::{Incircle, Insphere, Orient2d, Orient3d};
    use crate::predicates::{Point2, Point3, big};
    use crate::random::Random;

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

    /// Compares with big integers, and counts certain and uncertain signs.
    fn check<F: Form<N, D>, const N: usize, const D: usize>(
        from: [f64; D],
        to: [[f64; D]; N],
        counts: &mut [usize; 2],
    ) {
        let exact = big::sign::<F, N, D>(from, to);
        match sign::<F, N, D>(from, to) {
            Ok(sign) => assert_eq!(sign, exact),
            Err(bound) => assert!(exact == Sign::Zero || bound > 0.0),
        }
        counts[usize::from(sign::<F, N, D>(from, to).is_err())] += 1;
    }

    #[test]
    fn certain_signs_are_exact() {
        let mut random = Random::new(1);
        let mut counts = [[0; 2]; 4];
        for case in 0..20_000 {
            let (aside, is_level) = (2f64.powi(case % 60 - 20), case % 4 == 0);
            let p = square(&mut random, aside, is_level);
            check::<Incircle, 3, 2>(p[3], [p[0], p[1], p[2]], &mut counts[0]);
            let middle = [0, 1].map(|axis| p[0][axis].midpoint(p[1][axis]));
            check::<Orient2d, 2, 2>(middle, [p[0], p[1]], &mut counts[1]);
            let p = corners(&mut random, aside, is_level);
            check::<Orient3d, 3, 3>(p[0], [p[1], p[2], p[3]], &mut counts[2]);
            check::<Insphere, 4, 3>(p[7], [p[0], p[1], p[2], p[4]], &mut counts[3]);
        }
        assert!(
            counts.iter().all(|&[certain, uncertain]| certain > 5_000 && uncertain > 1_000),
            "{counts:?}"
        );
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
        let [a, b, c, d] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert!(sign::<Incircle, 3, 2>(d, [a, b, c]).is_err_and(|bound| bound > 0.0 && bound < 1e-28));
        assert!(sign::<Orient2d, 2, 2>([2.0, 6.0], [[0.0, 0.0], [1.0, 3.0]]).is_err());
        assert!(sign::<Orient3d, 3, 3>([0.0; 3], [[1.0; 3], [2.0; 3], [5.0, 7.0, 9.0]]).is_err());
    }
}

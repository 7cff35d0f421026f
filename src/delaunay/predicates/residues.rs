//! Determinants modulo a power of two: exact signs of values that are known to be small.
//!
//! Finite `f64` are integers in units of a power of two, which may differ among the axes. In the product of these
//! units a determinant is an integer V. If |V| < 2^(64 L - 1), its residue modulo 2^(64 L) tells V itself, zero
//! included. Intermediates need not fit, as they are residues, too. So a product takes a few native
//! multiplications and no memory. Pairs of `f64` that leave the sign open have shown that |V| is small.

use super::Sign;
use super::exact_integers::decompose;
use super::forms::{Form, lift};
use num_traits::Zero;
use std::ops::{Add, Mul, Sub};

/// An integer modulo 2^(64 L), the least digit first.
#[derive(Debug, Clone, Copy)]
pub struct Residue<const L: usize>([u64; L]);

impl<const L: usize> Residue<L> {
    /// `significand * 2^shift`.
    #[inline(always)]
    pub fn shifted(significand: i64, shift: u32) -> Self {
        let (digit, bits) = ((shift / 64) as usize, shift % 64);
        let parts = (i128::from(significand)) << bits;
        let extension = (parts >> 127) as u64;
        Residue(std::array::from_fn(|i| match i.wrapping_sub(digit) {
            0 => parts as u64,
            1 => (parts >> 64) as u64,
            _ if i < digit => 0,
            _ => extension,
        }))
    }

    /// The sign of the integer with this residue and the least magnitude.
    #[inline(always)]
    pub fn sign(self) -> Sign {
        if self.0[L - 1] >> 63 == 1 {
            Sign::Negative
        } else if self.is_zero() {
            Sign::Zero
        } else {
            Sign::Positive
        }
    }
}

impl<const L: usize> Zero for Residue<L> {
    #[inline(always)]
    fn zero() -> Self {
        Residue([0; L])
    }

    #[inline(always)]
    fn is_zero(&self) -> bool {
        self.0.iter().all(|digit| *digit == 0)
    }
}

impl<const L: usize> Add for Residue<L> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let mut carry = false;
        Residue(std::array::from_fn(|i| {
            let (sum, first) = self.0[i].overflowing_add(other.0[i]);
            let (sum, second) = sum.overflowing_add(u64::from(carry));
            carry = first | second;
            sum
        }))
    }
}

impl<const L: usize> Sub for Residue<L> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let mut borrow = false;
        Residue(std::array::from_fn(|i| {
            let (difference, first) = self.0[i].overflowing_sub(other.0[i]);
            let (difference, second) = difference.overflowing_sub(u64::from(borrow));
            borrow = first | second;
            difference
        }))
    }
}

impl<const L: usize> Mul for Residue<L> {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        let mut product = [0; L];
        for i in 0..L {
            let mut carry = 0;
            for j in 0..L - i {
                let sum = u128::from(self.0[i]) * u128::from(other.0[j])
                    + u128::from(product[i + j])
                    + u128::from(carry);
                product[i + j] = sum as u64;
                carry = (sum >> 64) as u64;
            }
        }
        Residue(product)
    }
}

/// Greatest number of digits.
const MOST: usize = 12;

/// Differences from one point to others, as integers in powers of two, one for each axis.
pub struct Integers<const N: usize, const D: usize> {
    from: [Odd; D],
    to: [[Odd; D]; N],
    units: [i32; D],
    /// All coordinates of an axis are below two to this power.
    tops: [i32; D],
}

impl<const N: usize, const D: usize> Integers<N, D> {
    /// Domain: finite coordinates.
    #[inline(always)]
    pub fn of(from: [f64; D], to: [[f64; D]; N]) -> Self {
        let (mut units, mut tops) = ([Odd::ZERO.exponent; D], [i32::MIN / 8; D]);
        let mut numbers = |point: [f64; D]| {
            let mut numbers = [Odd::ZERO; D];
            for axis in 0..D {
                numbers[axis] = Odd::of(point[axis]);
                units[axis] = units[axis].min(numbers[axis].exponent);
                tops[axis] = tops[axis].max(exponent_above(point[axis].abs()));
            }
            numbers
        };
        let mut integers =
            Integers { from: numbers(from), to: [[Odd::ZERO; D]; N], units: [0; D], tops: [0; D] };
        for (place, point) in integers.to.iter_mut().zip(to) {
            *place = numbers(point);
        }
        (integers.units, integers.tops) = (units, tops);
        integers
    }

    /// The least unit of an axis: that of lengths.
    #[inline(always)]
    fn unit(&self) -> i32 {
        self.units.iter().fold(Odd::ZERO.exponent, |least, unit| least.min(*unit))
    }

    /// The exponent of the power of two of which a form is a multiple: each of its products has one factor of
    /// each axis, and perhaps a lift.
    #[inline(always)]
    fn unit_of_value(&self, is_lifted: bool) -> i32 {
        self.units.iter().sum::<i32>() + if is_lifted { 2 * self.unit() } else { 0 }
    }

    /// Bits of the magnitude of a form in this power of two, at most.
    #[inline(always)]
    fn bits(&self, is_lifted: bool) -> i32 {
        let greatest = self.tops.iter().fold(i32::MIN / 8, |greatest, top| greatest.max(*top));
        // Differences have a bit more than coordinates.
        let factors = self.tops.iter().sum::<i32>() + D as i32;
        let lift = if is_lifted { 2 * (greatest + 1) } else { 0 };
        // At most 2, 6, 24 or, with the squares of a lift, 12, 72, 480 products.
        let products = [[1, 3, 5], [4, 7, 9]][usize::from(is_lifted)][D - 2];
        factors + lift + products - self.unit_of_value(is_lifted)
    }

    /// The sign of a form, if residues of two digits tell it, whatever its value.
    #[inline(always)]
    pub(super) fn sign_of_small<F: Form<N, D>>(&self) -> Option<Sign> {
        (self.bits(F::IS_LIFTED) < 128).then(|| self.sign::<F, 2>())
    }

    /// The sign of a form that is less than `bound`, if it is known, and if residues of up to twelve digits tell
    /// it.
    pub(super) fn sign_below<F: Form<N, D>>(&self, bound: Option<f64>) -> Option<Sign> {
        let bits = match bound {
            Some(0.0) => return Some(Sign::Zero),
            Some(bound) => exponent_above(bound) - self.unit_of_value(F::IS_LIFTED),
            None => self.bits(F::IS_LIFTED),
        };
        match bits {
            ..128 => Some(self.sign::<F, 2>()),
            128..256 => Some(self.sign::<F, 4>()),
            256..384 => Some(self.sign::<F, 6>()),
            384..768 => Some(self.sign::<F, MOST>()),
            _ => None,
        }
    }

    #[inline(never)]
    fn sign<F: Form<N, D>, const L: usize>(&self) -> Sign {
        let vectors = self.differences::<L>(self.units);
        let unit = self.unit();
        if !F::IS_LIFTED || self.units == [unit; D] {
            return F::value(&vectors, |i| lift(&vectors[i])).sign();
        }
        let of_lengths = self.lengths::<L>();
        F::value(&vectors, |i| lift(&of_lengths[i])).sign()
    }

    /// The differences in one unit for all axes.
    #[inline(always)]
    pub fn lengths<const L: usize>(&self) -> [[Residue<L>; D]; N] {
        self.differences([self.unit(); D])
    }

    /// Bits of the magnitude of a difference in this unit, at most.
    pub fn bits_of_lengths(&self) -> i32 {
        self.tops.iter().fold(i32::MIN / 8, |greatest, top| greatest.max(*top)) + 1 - self.unit()
    }

    #[inline(always)]
    fn differences<const L: usize>(&self, units: [i32; D]) -> [[Residue<L>; D]; N] {
        let mut differences = [[Residue([0; L]); D]; N];
        let mut from = differences[0];
        for axis in 0..D {
            from[axis] = self.from[axis].residue(units[axis]);
        }
        for (difference, point) in differences.iter_mut().zip(&self.to) {
            for axis in 0..D {
                difference[axis] = point[axis].residue(units[axis]) - from[axis];
            }
        }
        differences
    }
}

/// A number as an odd integer times a power of two, or zero.
#[derive(Debug, Clone, Copy)]
struct Odd {
    significand: i64,
    exponent: i32,
}

impl Odd {
    /// Its exponent is greater than those of all finite numbers.
    const ZERO: Odd = Odd { significand: 0, exponent: 1024 };

    #[inline(always)]
    fn of(value: f64) -> Self {
        let (significand, exponent) = decompose(value);
        if significand == 0 {
            return Odd::ZERO;
        }
        let zeros = significand.trailing_zeros();
        Odd { significand: significand >> zeros, exponent: exponent + zeros as i32 }
    }

    /// The number in the power of two with exponent `unit`, of which it is a multiple.
    #[inline(always)]
    fn residue<const L: usize>(self, unit: i32) -> Residue<L> {
        Residue::shifted(self.significand, (self.exponent - unit) as u32)
    }
}

/// `value < 2^exponent`. Domain: not negative.
#[inline(always)]
fn exponent_above(value: f64) -> i32 {
    (value.to_bits() >> 52) as i32 - 1022
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::predicates::big;
    use crate::predicates::forms::{Incircle, Insphere, Orient2d, Orient3d};
    use crate::random::Random;
    use num_bigint::BigInt;

    fn signed<const L: usize>(residue: Residue<L>) -> BigInt {
        let bytes: Vec<u8> = residue.0.iter().flat_map(|digit| digit.to_le_bytes()).collect();
        BigInt::from_signed_bytes_le(&bytes)
    }

    fn agrees_with_big_integers<const L: usize>(random: &mut Random) {
        let mut number = || {
            let shift = (random.bits() % 20) as u32 + 64 * (random.bits() % L as u64) as u32;
            let significand = random.bits() as i64 >> (11 + random.bits() % 50);
            (Residue::<L>::shifted(significand, shift), BigInt::from(significand) << shift)
        };
        let modulus = BigInt::from(1) << (64 * L);
        for _ in 0..2_000 {
            let ((a, big_a), (b, big_b)) = (number(), number());
            for (residue, exact) in
                [(a + b, &big_a + &big_b), (a - b, &big_a - &big_b), (a * b, &big_a * &big_b)]
            {
                let error = signed(residue) - exact;
                assert_eq!(error % &modulus, BigInt::ZERO);
                let sign = [Sign::Zero, Sign::Positive, Sign::Negative]
                    .into_iter()
                    .find(|&sign| sign == Sign::of(signed(residue)));
                assert_eq!(Some(residue.sign()), sign);
            }
        }
    }

    #[test]
    fn residues_are_congruent_to_integers() {
        let mut random = Random::new(1);
        agrees_with_big_integers::<2>(&mut random);
        agrees_with_big_integers::<4>(&mut random);
        agrees_with_big_integers::<MOST>(&mut random);
    }

    /// Compares signs, with no bound and with the sharpest one. Counts those that are found, and zeros.
    fn compare<F: Form<N, D>, const N: usize, const D: usize>(
        from: [f64; D],
        to: [[f64; D]; N],
        counts: &mut [usize; 2],
    ) {
        let exact = big::sign::<F, N, D>(from, to);
        let integers = Integers::of(from, to);
        if let Some(found) = integers.sign_below::<F>(None) {
            assert_eq!(found, exact, "{from:?} {to:?}");
            counts[0] += 1;
            counts[1] += usize::from(exact == Sign::Zero);
        }
        if exact == Sign::Zero {
            assert_eq!(integers.sign_below::<F>(Some(f64::MIN_POSITIVE)).unwrap_or(exact), exact);
        }
        assert_eq!(integers.sign_of_small::<F>().unwrap_or(exact), exact);
    }

    #[test]
    fn signs_are_those_of_big_integers() {
        let mut random = Random::new(2);
        let mut counts = [[0; 2]; 4];
        for case in 0..20_000 {
            // Corners of boxes are cocircular and cospherical, and close to it where one coordinate differs.
            let scale = 2f64.powi((random.bits() % 2_000) as i32 - 1_000);
            let spread = (random.bits() % 30) as i32;
            let mut number = || {
                ((random.bits() >> 12) as f64 - 2f64.powi(51))
                    * 2f64.powi(-(random.bits() as i32 & 31) * spread / 31 - 52)
            };
            let sides = [(); 3].map(|()| [number() * scale, number() * scale]);
            let mut corner =
                |code: usize| -> [f64; 3] { std::array::from_fn(|axis| sides[axis][code >> axis & 1]) };
            let [a, b, c, d, mut e] = [0, 3, 5, 6, 7].map(&mut corner);
            if case % 3 == 0 {
                e[case % 2] = e[case % 2].next_up();
            }
            let flat = |p: [f64; 3]| [p[0], p[1]];
            compare::<Insphere, 4, 3>(e, [a, b, c, d], &mut counts[0]);
            compare::<Orient3d, 3, 3>(e, [a, c, corner(2)], &mut counts[1]);
            compare::<Incircle, 3, 2>(flat(e), [flat(a), flat(b), flat(c)], &mut counts[2]);
            compare::<Orient2d, 2, 2>(flat(corner(1)), [flat(e), flat(e)], &mut counts[3]);
        }
        assert!(counts.iter().all(|&[found, zero]| found > 15_000 && zero > 3_000), "{counts:?}");
    }
}

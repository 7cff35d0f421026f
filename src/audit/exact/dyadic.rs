//! Coordinates as exact integers: all of them multiplied by a common power of two. Integers of 320 bits take
//! the determinants of coordinates whose differences have at most 61 bits.

use std::cmp::Ordering;
use std::ops::{Add, Mul, Sub};

use num_bigint::BigInt;

/// The first points relative to the last, times a common power of two; `None` if a difference exceeds 2^61.
/// The last point itself becomes zero.
pub(super) fn small_differences<const N: usize, const D: usize>(
    points: [[f64; D]; N],
) -> Option<[[i64; D]; N]> {
    let integers = whole(&points).or_else(|| scaled(&points))?;
    let mut differences = [[0; D]; N];
    for (difference, point) in differences.iter_mut().zip(&integers) {
        for axis in 0..D {
            let value = point[axis] - integers[N - 1][axis];
            if value.abs() > 1 << 61 {
                return None;
            }
            difference[axis] = value as i64;
        }
    }
    Some(differences)
}

/// The points themselves; `None` unless all coordinates are integers below 2^62.
fn whole<const N: usize, const D: usize>(points: &[[f64; D]; N]) -> Option<[[i128; D]; N]> {
    let is_whole = |value: f64| value.abs() < (1i64 << 62) as f64 && value as i64 as f64 == value;
    let all = points.as_flattened().iter().all(|&value| is_whole(value));
    all.then(|| points.map(|point| point.map(|value| i128::from(value as i64))))
}

/// The points times a power of two; `None` unless they are then below 2^124.
fn scaled<const N: usize, const D: usize>(points: &[[f64; D]; N]) -> Option<[[i128; D]; N]> {
    let (dyadics, unit) = dyadics(points);
    let fits = |value: &Dyadic| value.mantissa == 0 || value.exponent - unit <= 70;
    dyadics.as_flattened().iter().all(fits).then(|| {
        dyadics.map(|point| {
            point.map(|value| match value.mantissa {
                0 => 0,
                mantissa => i128::from(mantissa) << (value.exponent - unit),
            })
        })
    })
}

/// The points times a common power of two.
pub(crate) fn integers<const N: usize, const D: usize>(points: [[f64; D]; N]) -> [[BigInt; D]; N] {
    let (dyadics, unit) = dyadics(&points);
    dyadics.map(|point| {
        point.map(|value| match value.mantissa {
            0 => BigInt::ZERO,
            mantissa => BigInt::from(mantissa) << (value.exponent - unit),
        })
    })
}

/// The points relative to `origin`.
pub(super) fn differences<const N: usize, const D: usize>(
    points: [[BigInt; D]; N],
    origin: &[BigInt; D],
) -> [[BigInt; D]; N] {
    points.map(|point| std::array::from_fn(|axis| &point[axis] - &origin[axis]))
}

/// A finite f64 as `mantissa * 2^exponent`, the mantissa odd or zero.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Dyadic {
    pub(crate) mantissa: i64,
    pub(crate) exponent: i32,
}

impl Dyadic {
    pub(crate) fn of(value: f64) -> Self {
        let bits = value.to_bits();
        let fraction = (bits & ((1 << 52) - 1)) as i64;
        let (magnitude, exponent) = match (bits >> 52 & 0x7ff) as i32 {
            0 => (fraction, -1074),
            biased => (fraction | 1 << 52, biased - 1075),
        };
        if magnitude == 0 {
            return Dyadic { mantissa: 0, exponent: 0 };
        }
        let zeros = magnitude.trailing_zeros();
        let odd = magnitude >> zeros;
        Dyadic { mantissa: if value < 0.0 { -odd } else { odd }, exponent: exponent + zeros as i32 }
    }
}

/// The coordinates taken apart, and their smallest exponent.
fn dyadics<const N: usize, const D: usize>(points: &[[f64; D]; N]) -> ([[Dyadic; D]; N], i32) {
    let dyadics = points.map(|point| point.map(Dyadic::of));
    let exponents = dyadics.as_flattened().iter().filter(|value| value.mantissa != 0);
    let unit = exponents.map(|value| value.exponent).min().unwrap_or(0);
    (dyadics, unit)
}

/// A signed integer modulo 2^320, in two's complement, lowest limb first: exact while results stay below
/// 2^319.
///
/// The largest expression of the audit is the in-sphere determinant: four products of a lift of at most
/// 3 * 2^122 and a minor of at most 6 * 2^183, so 72 * 2^305 < 2^312.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Wide([u64; LIMBS]);

const LIMBS: usize = 5;

impl From<i64> for Wide {
    fn from(value: i64) -> Self {
        let extension = if value < 0 { u64::MAX } else { 0 };
        let mut limbs = [extension; LIMBS];
        limbs[0] = value as u64;
        Wide(limbs)
    }
}

impl Wide {
    /// The order of the value to zero.
    pub(super) fn sign(self) -> Ordering {
        if (self.0[LIMBS - 1] as i64) < 0 {
            Ordering::Less
        } else if self.0 == [0; LIMBS] {
            Ordering::Equal
        } else {
            Ordering::Greater
        }
    }
}

impl Add for Wide {
    type Output = Wide;

    fn add(self, other: Wide) -> Wide {
        let mut carry = false;
        Wide(std::array::from_fn(|i| {
            let (sum, over) = self.0[i].overflowing_add(other.0[i]);
            let (sum, over_again) = sum.overflowing_add(u64::from(carry));
            carry = over || over_again;
            sum
        }))
    }
}

impl Sub for Wide {
    type Output = Wide;

    fn sub(self, other: Wide) -> Wide {
        let mut borrow = false;
        Wide(std::array::from_fn(|i| {
            let (difference, under) = self.0[i].overflowing_sub(other.0[i]);
            let (difference, under_again) = difference.overflowing_sub(u64::from(borrow));
            borrow = under || under_again;
            difference
        }))
    }
}

impl Mul for Wide {
    type Output = Wide;

    /// Modulo 2^320, the product of the two's complements is the two's complement of the product.
    fn mul(self, other: Wide) -> Wide {
        let mut product = [0u64; LIMBS];
        for i in 0..LIMBS {
            let mut carry = 0;
            for j in 0..LIMBS - i {
                let sum = u128::from(self.0[i]) * u128::from(other.0[j]) + u128::from(product[i + j]) + carry;
                product[i + j] = sum as u64;
                carry = sum >> 64;
            }
        }
        Wide(product)
    }
}

#[cfg(test)]
mod tests {
    use num_bigint::BigInt;

    use super::*;

    fn big(value: Wide) -> BigInt {
        let magnitude = value.0.iter().rev().fold(BigInt::ZERO, |sum, &limb| (sum << 64) + limb);
        if value.sign() == Ordering::Less { magnitude - (BigInt::from(1) << 320) } else { magnitude }
    }

    #[test]
    fn arithmetic_is_that_of_integers() {
        let mut state = 9_u64;
        for _ in 0..2_000 {
            let mut value = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let any = (state as i64) >> 2 >> (state >> 58);
                [0, 1, -1, 1 << 61, -(1 << 61), any][(state >> 32) as usize % 6]
            };
            let [a, b, c, d, e] = [(); 5].map(|()| value());
            let wide = |value: i64| Wide::from(value);
            let found = wide(a) * wide(b) * wide(c) * wide(d) * wide(e) - wide(a) * wide(c) + wide(e);
            let [a, b, c, d, e] = [a, b, c, d, e].map(BigInt::from);
            let expected = &a * b * &c * d * &e - a * c + e;
            assert_eq!(big(found), expected);
            assert_eq!(found.sign(), expected.cmp(&BigInt::ZERO));
        }
    }
}

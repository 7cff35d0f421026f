//! Integers of 320 bits, for determinants of coordinates whose differences have at most 61 bits.

use std::cmp::Ordering;
use std::ops::{Add, Mul, Sub};

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

//! Numbers of some 106 bits, with a bound on their error.

use std::ops::{Add, Mul, Sub};

use crate::tess3::exact::Number;

/// The sum of two `f64`, the second at most half a unit in the last place of the first, that differs from an
/// exact number by at most `error`. What over- or underflows has a bound that is no number or too great.
#[derive(Debug, Clone, Copy)]
pub(super) struct Double {
    pub(super) high: f64,
    pub(super) low: f64,
    pub(super) error: f64,
}

/// Splits a number in two of half the digits (Veltkamp, Dekker 1971).
const SPLITTER: f64 = ((1u64 << 27) + 1) as f64;

/// With u = 2^-53, a sum of pairs errs by at most 4 u² times the magnitudes of its terms, and a product by at
/// most 9 u² times its magnitude, both generously: see the derivation in `predicates/pairs.rs` of the
/// geometry.
const OF_SUM: f64 = f64::EPSILON * f64::EPSILON;
const OF_PRODUCT: f64 = 3.0 * f64::EPSILON * f64::EPSILON;

/// Covers the roundings of the bounds themselves.
const OF_BOUNDS: f64 = 1.0 + 16.0 * f64::EPSILON;

impl Double {
    /// A number without error.
    pub(super) fn exactly(value: f64) -> Self {
        Double { high: value, low: 0.0, error: 0.0 }
    }

    /// Whether the error is at most this share of the number.
    pub(super) fn is_within(self, share: f64) -> bool {
        self.high.is_finite() && self.error <= self.high.abs() * share
    }

    /// The quotient, with an error of at most 32 u² of it beside those of the operands, if nothing over- or
    /// underflows. Its own bound is not computed.
    pub(super) fn over(self, divisor: Self) -> [f64; 2] {
        let first = self.high / divisor.high;
        let rest = self - divisor * Double::exactly(first);
        exact_sum(first, rest.high / divisor.high)
    }
}

impl Number for Double {}

/// A sum and its rounding error (Knuth).
fn exact_sum(a: f64, b: f64) -> [f64; 2] {
    let sum = a + b;
    let b_part = sum - a;
    let a_part = sum - b_part;
    [sum, (a - a_part) + (b - b_part)]
}

/// A product and its rounding error (Dekker).
fn exact_product(a: f64, b: f64) -> [f64; 2] {
    let split = |number: f64| {
        let scaled = SPLITTER * number;
        let high = scaled - (scaled - number);
        [high, number - high]
    };
    let product = a * b;
    let ([a_high, a_low], [b_high, b_low]) = (split(a), split(b));
    [product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low]
}

impl Add for Double {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let [sum, left] = exact_sum(self.high, other.high);
        let [high, low] = exact_sum(sum, left + (self.low + other.low));
        let rounding = OF_SUM * (self.high.abs() + other.high.abs());
        Double { high, low, error: (self.error + other.error + rounding) * OF_BOUNDS }
    }
}

impl Sub for Double {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + Double { high: -other.high, low: -other.low, ..other }
    }
}

impl Mul for Double {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let [product, left] = exact_product(self.high, other.high);
        let [high, low] = exact_sum(product, left + (self.high * other.low + self.low * other.high));
        let inherited = self.high.abs() * other.error + (other.high.abs() + other.error) * self.error;
        // The least normal number is far more than what is lost when parts underflow.
        let rounding = OF_PRODUCT * product.abs() + f64::MIN_POSITIVE;
        Double { high, low, error: (inherited + rounding) * OF_BOUNDS }
    }
}

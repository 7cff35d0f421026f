//! Values of simplices: some 106 bits of them, and the exact fraction when these do not decide.

use std::cmp::Ordering;

use num_bigint::{BigInt, Sign};

use super::double::Double;
use super::orthosphere::Fraction;

/// Share of a value that is the greatest error of a [`Value`] in the range of normal numbers.
pub(super) const ERROR: f64 = 1.0 / (1u128 << 70) as f64;

/// Greatest error that a [`Value`] may have beside that, as it underflows.
const TINY: f64 = 1e-290;

/// A value, rounded: its error is at most [`ERROR`] of it. It is infinite if it overflows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Value {
    pub(super) high: f64,
    pub(super) low: f64,
}

impl Value {
    /// A value without error.
    pub(super) fn exactly(value: f64) -> Value {
        Value { high: value, low: 0.0 }
    }

    /// The quotient, if it is certain to be accurate enough.
    pub(super) fn of_doubles(fraction: &Fraction<Double>) -> Option<Value> {
        let Fraction { numerator, denominator } = *fraction;
        let [high, low] = numerator.over(denominator);
        // A quarter of the error for each of the operands leaves a half for the division.
        let is_accurate = numerator.is_within(ERROR / 4.0) && denominator.is_within(ERROR / 4.0);
        let is_normal = high.abs() > TINY && high.is_finite();
        (is_accurate && is_normal).then_some(Value { high, low })
    }

    /// The quotient times 4 to the power of `exponent`.
    pub(super) fn of_fraction(fraction: &Fraction<BigInt>, exponent: i32) -> Value {
        const DIGITS: i64 = 120;
        let Fraction { numerator, denominator } = fraction;
        if numerator.sign() == Sign::NoSign {
            return Value::exactly(0.0);
        }
        let shift = DIGITS - (numerator.bits() as i64 - denominator.bits() as i64);
        let (dividend, divisor) = (numerator.magnitude(), denominator.magnitude());
        let quotient = match usize::try_from(shift) {
            Ok(shift) => (dividend << shift) / divisor,
            Err(_) => dividend / (divisor << shift.unsigned_abs() as usize),
        };
        let quotient = u128::try_from(quotient).expect("about 120 bits");
        let high = quotient as f64;
        // Two steps, as the power of two may be out of the range of f64 where the result is not.
        let power = (2 * i64::from(exponent) - shift).clamp(-4000, 4000) as i32;
        let scaled = |part: f64| (0..4).fold(part, |part, step| part * 2f64.powi((power + step) >> 2));
        let (high, low) = (scaled(high), scaled((quotient as i128 - high as i128) as f64));
        if numerator.sign() == Sign::Minus { Value { high: -high, low: -low } } else { Value { high, low } }
    }

    /// An order of rounded values that contradicts that of the values only if they are [in
    /// doubt](Value::is_in_doubt).
    pub(super) fn rounded_order(&self, other: &Value) -> Ordering {
        self.high.total_cmp(&other.high).then(self.low.total_cmp(&other.low))
    }

    /// Whether another value, which is not less when rounded, may in truth be equal or less.
    pub(super) fn is_in_doubt(&self, greater: &Value) -> bool {
        let error = |value: &Value| value.high.abs() * (4.0 * ERROR) + TINY;
        let room = (greater.high - self.high) + (greater.low - self.low);
        // False also for values that overflow, with which the room is no number.
        let is_certain = room > error(self) + error(greater);
        !is_certain
    }
}

impl Fraction<BigInt> {
    /// Compares the exact quotients.
    pub(super) fn compare(&self, other: &Self) -> Ordering {
        (&self.numerator * &other.denominator).cmp(&(&other.numerator * &self.denominator))
    }
}

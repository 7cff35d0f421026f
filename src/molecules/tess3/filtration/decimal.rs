//! Exact values as decimal numbers.

use std::io::Write;

use num_bigint::{BigInt, BigUint, Sign};

use super::double::Double;
use super::orthosphere::Fraction;
use super::value::{ERROR, Value};
use crate::tess3::alpha::Radius;

/// Digits of values that are no shorter decimal numbers. Fewer would not tell all `f64` apart.
const DIGITS: i32 = 17;
const LIMIT: u64 = 10u64.pow(DIGITS as u32);

/// Exponents of ten of the first digit for which a number is written without exponent.
const PLAIN: std::ops::Range<i32> = -7..DIGITS;

/// A number of [`DIGITS`] digits times ten to a power.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Decimal {
    digits: u64,
    exponent: i32,
    is_exact: bool,
}

/// Writes values in squares of stored units as decimals in squares of world units.
#[derive(Debug)]
pub(super) struct Decimals {
    /// Squares of numerator and denominator of the scale.
    scale: [BigInt; 2],
    /// The same, rounded.
    rounded_scale: [Double; 2],
    /// Exponent of four of the unit of fractions.
    exponent: i32,
    powers: Vec<Double>,
}

impl Decimals {
    /// `scale` stands for the shortest decimal that is rounded to it: world units per stored unit.
    pub(super) fn new(scale: f64, exponent: i32) -> Self {
        let scale: Radius = scale.to_string().parse().expect("a scale is a positive number");
        let scale = scale.squares_in(0);
        let rounded_scale = scale.each_ref().map(double);
        let powers = (0..40).map(|power| double(&BigInt::from(10).pow(power))).collect();
        Decimals { scale, rounded_scale, exponent, powers }
    }

    /// Appends a value and the bound on its error: half a unit of the last digit, or 0 if it is exact.
    pub(super) fn write(
        &self,
        text: &mut Vec<u8>,
        value: &Value,
        exact: impl FnOnce() -> Fraction<BigInt>,
    ) -> std::io::Result<()> {
        if let Some(decimal) = self.fast(value) {
            if value.high < 0.0 {
                text.push(b'-');
            }
            return decimal.write(text);
        }
        let Fraction { numerator, denominator } = exact();
        if numerator.sign() == Sign::Minus {
            text.push(b'-');
        }
        self.exactly(&numerator.into_parts().1, denominator.magnitude()).write(text)
    }

    /// The digits of a magnitude, if the rounded value tells them and that they are not exact.
    fn fast(&self, value: &Value) -> Option<Decimal> {
        let [numerator, denominator] = self.rounded_scale;
        let [high, low] =
            (Double { high: value.high, low: value.low, error: 0.0 } * numerator).over(denominator);
        let value = if high < 0.0 { [-high, -low] } else { [high, low] };
        let first_digit = value[0].log10().floor();
        if !(-20.0..30.0).contains(&first_digit) {
            return None;
        }
        let power = DIGITS - 1 - first_digit as i32;
        let scaled = Double { high: value[0], low: value[1], error: 0.0 };
        let factor = self.powers[power.unsigned_abs() as usize];
        let [high, low] = if power < 0 {
            scaled.over(factor)
        } else {
            let product = scaled * factor;
            [product.high, product.low]
        };
        // Near a power of ten, the estimate of the first digit may be off by one.
        if !((LIMIT / 10 + 100) as f64..(LIMIT - 100) as f64).contains(&high) {
            return None;
        }
        // Both parts are far below 2^63, and the high one has no fraction.
        let fraction = low - low.floor();
        let digits = (high as i64 + low.floor() as i64) as u64;
        let is_certain = [0.0, 0.5, 1.0].iter().all(|doubtful| (fraction - doubtful).abs() > UNSURE);
        is_certain.then_some(Decimal {
            digits: digits + u64::from(fraction > 0.5),
            exponent: -power,
            is_exact: false,
        })
    }

    /// The digits of a quotient in units of fractions.
    fn exactly(&self, numerator: &BigUint, denominator: &BigUint) -> Decimal {
        if *numerator == BigUint::ZERO {
            return Decimal { digits: 0, exponent: 0, is_exact: true };
        }
        let shift = 2 * self.exponent.unsigned_abs() as usize;
        let [up, down] = if self.exponent < 0 { [0, shift] } else { [shift, 0] };
        let numerator = (numerator * self.scale[0].magnitude()) << up;
        let denominator = (denominator * self.scale[1].magnitude()) << down;
        let bits = numerator.bits() as f64 - denominator.bits() as f64;
        let mut power = DIGITS - 1 - (bits * std::f64::consts::LOG10_2).floor() as i32;
        loop {
            let ten = BigUint::from(10u32).pow(power.unsigned_abs());
            let [dividend, divisor] = if power < 0 {
                [numerator.clone(), &denominator * ten]
            } else {
                [&numerator * ten, denominator.clone()]
            };
            let quotient = &dividend / &divisor;
            let rest = dividend - &quotient * &divisor;
            let is_exact = rest == BigUint::ZERO;
            let twice = rest << 1;
            let quotient = u64::try_from(quotient).expect("about 17 digits");
            let is_up = twice > divisor || (twice == divisor && quotient % 2 == 1);
            let digits = quotient + u64::from(is_up);
            // The quotient decides: digits that are rounded up to a power of ten would change the power for
            // ever.
            match quotient {
                LIMIT.. => power -= 1,
                _ if quotient < LIMIT / 10 => power += 1,
                _ if digits == LIMIT => {
                    return Decimal { digits: LIMIT / 10, exponent: 1 - power, is_exact: false };
                }
                _ => return Decimal { digits, exponent: -power, is_exact },
            }
        }
    }
}

/// Fractions of the last digit that are left to exact arithmetic. A [`Value`] errs by less than a tenth of
/// this.
const UNSURE: f64 = 1e-3;
const _: () = assert!(ERROR * (LIMIT as f64) < UNSURE / 10.0);

/// The first bits of an integer.
fn double(integer: &BigInt) -> Double {
    let Value { high, low } =
        Value::of_fraction(&Fraction { numerator: integer.clone(), denominator: BigInt::from(1) }, 0);
    Double { high, low, error: 0.0 }
}

impl Decimal {
    /// Appends the number, a blank, and the bound on its error.
    fn write(self, text: &mut Vec<u8>) -> std::io::Result<()> {
        let Decimal { digits, exponent, is_exact } = self;
        if digits == 0 {
            return text.write_all(b"0 0");
        }
        let mut digits_text = digits.to_string();
        if is_exact {
            digits_text.truncate(digits_text.trim_end_matches('0').len());
        }
        let first_digit = exponent + DIGITS - 1;
        if PLAIN.contains(&first_digit) {
            write_plain(text, &digits_text, first_digit)?;
        } else {
            let (first, others) = digits_text.split_at(1);
            let point = if others.is_empty() { "" } else { "." };
            write!(text, "{first}{point}{others}e{first_digit}")?;
        }
        if is_exact { text.write_all(b" 0") } else { write!(text, " 5e{}", exponent - 1) }
    }
}

/// Appends digits without exponent, of which the first counts ten to the power of `first_digit`.
fn write_plain(text: &mut Vec<u8>, digits: &str, first_digit: i32) -> std::io::Result<()> {
    let Ok(whole) = usize::try_from(first_digit + 1) else {
        return write!(text, "0.{:0>1$}", digits, digits.len() + first_digit.abs_diff(-1) as usize);
    };
    if whole >= digits.len() {
        return write!(text, "{digits:0<whole$}");
    }
    let (whole, fraction) = digits.split_at(whole);
    write!(text, "{}.{fraction}", if whole.is_empty() { "0" } else { whole })
}

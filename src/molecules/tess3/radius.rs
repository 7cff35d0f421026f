//! The radius of an alpha complex: the decimal number that the user wrote, not the nearest binary one.

use std::fmt;
use std::str::FromStr;

use num_bigint::BigInt;

use super::exact::Approximate;

/// Largest exponent of ten: beyond it nothing fits the range of coordinates.
const EXPONENT_MAX: i32 = 400;

/// Maximum length of the number, in characters.
const LEN_MAX: usize = 400;

/// A positive radius, exactly: the quotient of two integers.
#[derive(Debug, Clone, PartialEq)]
pub struct Radius {
    numerator: BigInt,
    denominator: BigInt,
    /// The radius as an f64, rounded a few times.
    approximate: f64,
}

impl Radius {
    /// The same radius in steps of `scale`, which stands for the shortest decimal that is rounded to it.
    pub fn in_steps(&self, scale: f64) -> Radius {
        let scale_in_digits: Radius = scale.to_string().parse().expect("a scale is a positive number");
        Radius {
            numerator: &self.numerator * scale_in_digits.denominator,
            denominator: &self.denominator * scale_in_digits.numerator,
            approximate: self.approximate / scale,
        }
    }

    /// Squares of numerator and denominator, rounded.
    pub(super) fn approximate_squares(&self) -> [Approximate; 2] {
        let radius = Approximate {
            value: self.approximate,
            error: self.approximate * 4.0 * f64::EPSILON + f64::MIN_POSITIVE,
        };
        [radius * radius, Approximate::exactly(1.0)]
    }

    /// Squares of numerator and denominator of the radius in units of 2^unit.
    pub(super) fn squares_in(&self, unit: i32) -> [BigInt; 2] {
        let shift = 2 * unit.unsigned_abs() as usize;
        let squares = [&self.numerator * &self.numerator, &self.denominator * &self.denominator];
        let [numerator, denominator] = squares;
        if unit < 0 { [numerator << shift, denominator] } else { [numerator, denominator << shift] }
    }
}

/// The value, rounded.
impl fmt::Display for Radius {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.approximate)
    }
}

impl FromStr for Radius {
    type Err = String;

    /// A positive decimal number, with or without exponent.
    fn from_str(text: &str) -> Result<Radius, String> {
        let refused = || format!("{text:?} is not a positive number like 2.8");
        let approximate: f64 = text.parse().map_err(|_| refused())?;
        if !(approximate > 0.0 && approximate.is_finite() && text.len() <= LEN_MAX) {
            return Err(refused());
        }
        let (digits, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
        let exponent: i32 = exponent.parse().map_err(|_| refused())?;
        let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
        let numerator: BigInt = format!("{whole}{fraction}").parse().map_err(|_| refused())?;
        let exponent = exponent.saturating_sub(fraction.len() as i32);
        if exponent.abs() > EXPONENT_MAX {
            return Err(refused());
        }
        let power = BigInt::from(10).pow(exponent.unsigned_abs());
        let one = BigInt::from(1);
        let [numerator, denominator] =
            if exponent < 0 { [numerator, power] } else { [numerator * power, one] };
        Ok(Radius { numerator, denominator, approximate })
    }
}

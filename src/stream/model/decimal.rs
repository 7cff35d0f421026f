//! Numbers as canonical decimals.

use std::fmt;
use std::str::FromStr;

/// Shows a number as the shortest decimal that reads back as the same number; of several, the closest; of two
/// that are equally close, the one with an even last digit (`formats/text.md`, Numbers). There is no exponent.
///
/// The standard library rounds such ties up, other languages to even: 900000000000000.25 is
/// `900000000000000.2` here.
#[derive(Debug, Clone, Copy)]
pub struct Decimal<T>(pub T);

/// A binary floating-point type.
pub trait Float: Copy + PartialEq + FromStr + fmt::Display + fmt::LowerExp {
    /// The least number of digits of a shortest decimal that another one can be as close as.
    ///
    /// Decimals of d digits are 10^(1-d) apart, relative to their first digit, and half of that must be within
    /// half a unit in the last place of the number.
    const TIE_DIGITS: usize;

    /// Whether the number has fewer digits than that for certain, which most numbers of users have.
    fn is_short(self) -> bool;
}

impl Float for f32 {
    const TIE_DIGITS: usize = 7;

    fn is_short(self) -> bool {
        (self * 10.0).abs() < 1e6 && (self * 10.0).trunc() / 10.0 == self
    }
}

impl Float for f64 {
    const TIE_DIGITS: usize = 16;

    fn is_short(self) -> bool {
        // What is nearest to a number of thousandths of at most 15 digits.
        (self * 1e3).abs() < 1e15 && ((self * 1e3 + 0.5f64.copysign(self)) as i64 as f64) / 1e3 == self
    }
}

impl<T: Float> fmt::Display for Decimal<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_short() {
            return fmt::Display::fmt(&self.0, f);
        }
        let text = self.0.to_string();
        f.write_str(even_of_tie(self.0, &text).as_deref().unwrap_or(&text))
    }
}

/// The digits of the shortest decimal of a finite number as an integer, and the power of ten of the last one;
/// `None` if they are no integer of 128 bits.
pub fn digits(value: f64) -> Option<(i128, i32)> {
    let text = format!("{value:e}");
    let (number, power) = text.split_once('e')?;
    let behind_point = number.split_once('.').map_or(0, |(_, digits)| digits.len() as i32);
    Some((number.replace('.', "").parse().ok()?, power.parse::<i32>().ok()? - behind_point))
}

/// The other decimal, if `text` was rounded up from halfway between two.
fn even_of_tie<T: Float>(number: T, text: &str) -> Option<String> {
    let last = *text.as_bytes().last()?;
    // An integer is never halfway between two such decimals: it would have too few factors 2 for its size.
    if text.len() <= T::TIE_DIGITS || last.is_multiple_of(2) || !text.contains('.') {
        return None;
    }
    let lower = format!("{}{}", &text[..text.len() - 1], char::from(last - 1));
    // Rounded to as many digits, ties become even.
    let rounded = format!("{number:.*e}", significant(text).count() - 1);
    let same = significant(&rounded).eq(significant(&lower));
    (same && lower.parse().is_ok_and(|read: T| read == number)).then_some(lower)
}

/// The digits of a number from the first that is not 0, without the exponent.
fn significant(text: &str) -> impl Iterator<Item = u8> {
    let mantissa = text.split('e').next().unwrap_or_default();
    mantissa.bytes().filter(u8::is_ascii_digit).skip_while(|&digit| digit == b'0')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ties_become_even() {
        let cases = [
            (9e14 + 0.25, "900000000000000.2"),
            (9e14 + 0.75, "900000000000000.8"),
            (3.0 + 2f64.powi(-17), "3.0000076293945312"),
            (-3.0 - 2f64.powi(-17), "-3.0000076293945312"),
            (28.016, "28.016"),
            (28.016_000_000_000_002, "28.016000000000002"),
            (1e22, "10000000000000000000000"),
            (-0.0, "-0"),
            (f64::INFINITY, "inf"),
        ];
        for (number, text) in cases {
            assert_eq!(Decimal(number).to_string(), text);
        }
        assert_eq!(Decimal(32_773.0 + 0.1875f32).to_string(), "32773.188");
        assert_eq!(Decimal(32_774.0 + 0.0625f32).to_string(), "32774.062");
    }

    /// Numbers with few bits have exact decimals, so that many of them are halfway between two short ones.
    #[test]
    fn no_decimal_of_as_many_digits_is_closer() {
        let mut ties = 0;
        for number in (0..200_000u32).map(|i| f32::from_bits(0x3f80_0000 + i * 83)) {
            let text = Decimal(number).to_string();
            assert_eq!(text.parse(), Ok(number));
            assert_eq!(text.len(), number.to_string().len());
            if text != number.to_string() {
                ties += 1;
                let distance = |text: &str| (text.parse::<f64>().unwrap() - f64::from(number)).abs();
                assert!((distance(&text) - distance(&number.to_string())).abs() < 1e-15, "{number}");
                assert!(text.ends_with(['0', '2', '4', '6', '8']));
            }
        }
        assert!(ties > 0);
    }
}

//! Fields of a line: words, numbers, and errors about them.

use crate::text::lines::{number, quote};
use spmesh_base::error::{Error, Result};

/// The fields of a line: runs of bytes without spaces and tabs.
pub(crate) fn fields(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|&byte| byte == b' ' || byte == b'\t').filter(|field| !field.is_empty())
}

/// A finite number in any decimal notation.
pub(crate) fn parse_decimal(field: &[u8]) -> Result<f64> {
    number(field).filter(|number| number.is_finite()).ok_or_else(|| unexpected(field, "a finite number"))
}

/// An unsigned integer.
pub(crate) fn parse_integer(field: &[u8]) -> Result<u64> {
    let digits = field.iter().all(u8::is_ascii_digit).then_some(field);
    let number = digits.and_then(|digits| std::str::from_utf8(digits).ok()?.parse().ok());
    number.ok_or_else(|| unexpected(field, "an integer"))
}

/// An integer with an optional sign.
pub(crate) fn parse_signed(field: &[u8]) -> Result<i64> {
    let number = std::str::from_utf8(field).ok().and_then(|text| text.parse().ok());
    number.ok_or_else(|| unexpected(field, "an integer"))
}

/// The next `N` fields as finite numbers.
pub(crate) fn parse_decimals<'a, const N: usize>(
    fields: &mut impl Iterator<Item = &'a [u8]>,
) -> Result<[f64; N]> {
    let mut numbers = [0.0; N];
    for number in &mut numbers {
        *number = parse_decimal(next_field(fields)?)?;
    }
    Ok(numbers)
}

/// The next field; an error if there is none.
pub(crate) fn next_field<'a>(fields: &mut impl Iterator<Item = &'a [u8]>) -> Result<&'a [u8]> {
    fields.next().ok_or_else(|| Error::malformed("the line ends early: a field is missing"))
}

/// Checks that no field is left.
pub(crate) fn expect_no_field<'a>(fields: &mut impl Iterator<Item = &'a [u8]>) -> Result<()> {
    fields.next().map_or(Ok(()), |field| Err(unexpected(field, "the end of the line")))
}

/// An error that quotes the start of `found`.
pub(crate) fn unexpected(found: &[u8], expected: &str) -> Error {
    Error::malformed(format!("found {}, expected {expected}", quote(found)))
}

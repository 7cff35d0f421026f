//! Serial and residue numbers of PDB files, and the ways in which they exceed their columns.

/// Smallest hybrid-36 number with upper-case letters, for a width of 4 or 5 characters.
fn hybrid36_start(width: usize) -> i64 {
    10i64.pow(width as u32)
}

/// The hybrid-36 number `text`, whose first character is a letter: first upper-case letters, then lower-case
/// letters.
///
/// Source: R. W. Grosse-Kunstleve, cctbx.
pub(crate) fn hybrid36(text: &str) -> Option<i64> {
    let width = text.len();
    let has_lower = text.bytes().any(|byte| byte.is_ascii_lowercase());
    let has_upper = text.bytes().any(|byte| byte.is_ascii_uppercase());
    if !matches!(width, 4 | 5) || has_lower == has_upper || !text.as_bytes()[0].is_ascii_alphabetic() {
        return None;
    }
    let number = i64::from_str_radix(text, 36).ok()?;
    let rest = 36i64.pow(width as u32 - 1);
    // The first letter, A, has the digit value 10. Lower-case numbers follow those of the 26 upper-case
    // letters.
    Some(number - 10 * rest + if has_lower { 26 * rest } else { 0 } + hybrid36_start(width))
}

/// Parses the serial numbers of a model, in order.
#[derive(Debug, Default)]
pub(crate) struct Serials {
    /// Whether numbers have become hexadecimal, as some programs write them after 99999.
    is_hexadecimal: bool,
}

impl Serials {
    /// The number that `text` denotes; `None` if it is not a number (asterisks, blanks).
    pub(crate) fn parse(&mut self, text: &str) -> Option<u64> {
        if self.is_hexadecimal {
            return u64::from_str_radix(text, 16).ok();
        }
        if text.bytes().all(|byte| byte.is_ascii_digit()) {
            return text.parse().ok();
        }
        if let Some(number) = hybrid36(text) {
            return u64::try_from(number).ok();
        }
        let digits = text.bytes().all(|byte| byte.is_ascii_hexdigit()).then_some(text)?;
        self.is_hexadecimal = true;
        u64::from_str_radix(digits, 16).ok()
    }
}

/// The number of a residue: decimal, hybrid-36, or hexadecimal.
pub(crate) fn residue_number(text: &str) -> Option<i32> {
    let number = text.parse().ok().or_else(|| hybrid36(text)).or_else(|| {
        // Numbers become hexadecimal only beyond the decimal range, so they fill their columns.
        let is_full = text.len() == 4 && text.bytes().all(|byte| byte.is_ascii_hexdigit());
        if is_full { i64::from_str_radix(text, 16).ok() } else { None }
    })?;
    i32::try_from(number).ok()
}

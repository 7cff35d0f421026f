//! Serial and residue numbers of PDB files, and the ways in which they go beyond their columns.

/// Smallest number of hybrid-36 with capital letters, by its width of 4 or 5 characters.
fn hybrid36_start(width: usize) -> i64 {
    10i64.pow(width as u32)
}

/// The number of `text` in hybrid-36, whose first character is a letter: capitals first, then small letters.
///
/// Source: R. W. Grosse-Kunstleve, cctbx.
pub(super) fn hybrid36(text: &str) -> Option<i64> {
    let width = text.len();
    let has_lower = text.bytes().any(|byte| byte.is_ascii_lowercase());
    let has_upper = text.bytes().any(|byte| byte.is_ascii_uppercase());
    if !matches!(width, 4 | 5) || has_lower == has_upper || !text.as_bytes()[0].is_ascii_alphabetic() {
        return None;
    }
    let number = i64::from_str_radix(text, 36).ok()?;
    let rest = 36i64.pow(width as u32 - 1);
    // Numbers start with ten for the letter A; small letters follow the 26 capitals.
    Some(number - 10 * rest + if has_lower { 26 * rest } else { 0 } + hybrid36_start(width))
}

/// Serial numbers of a model, from one to the next.
#[derive(Debug, Default)]
pub(super) struct Serials {
    /// Whether numbers have become hexadecimal, as some programs write them after 99999.
    is_hexadecimal: bool,
}

impl Serials {
    /// The number that `text` is; `None` if it is none (asterisks, blanks).
    pub(super) fn parse(&mut self, text: &str) -> Option<u64> {
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
pub(super) fn residue_number(text: &str) -> Option<i32> {
    let number = text.parse().ok().or_else(|| hybrid36(text)).or_else(|| {
        // Only a number that is too great for decimal digits is hexadecimal, and that fills its columns.
        let is_full = text.len() == 4 && text.bytes().all(|byte| byte.is_ascii_hexdigit());
        if is_full { i64::from_str_radix(text, 16).ok() } else { None }
    })?;
    i32::try_from(number).ok()
}

//! Numbers in tables.

use std::io::Write;

/// Digits that are printed: more than any coordinate of a structure has.
const DIGITS: i32 = 9;

/// Writes a nonnegative number with nine significant digits, without trailing zeros.
///
/// # Errors
/// If writing fails.
pub(super) fn write_number(text: &mut Vec<u8>, value: f64) -> std::io::Result<()> {
    let magnitude = if value > 0.0 { value.log10().floor() } else { 0.0 };
    if !(-5.0..15.0).contains(&magnitude) {
        return write!(text, "{value:.*e}", DIGITS as usize - 1);
    }
    let decimals = (DIGITS - 1 - magnitude as i32).max(0);
    write!(text, "{value:.*}", decimals as usize)?;
    if decimals > 0 {
        let zeros = text.iter().rev().take_while(|&&digit| digit == b'0').count();
        text.truncate(text.len() - zeros);
        text.pop_if(|last| *last == b'.');
    }
    Ok(())
}

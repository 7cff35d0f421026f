//! Numbers in tables.

use std::io::Write;

/// Digits that are printed: more than any coordinate of a structure has.
const DIGITS: i32 = 9;

/// Writes a number with nine significant digits, without trailing zeros.
pub(crate) fn write_number(text: &mut Vec<u8>, value: f64) {
    // Without the sign of a negative zero.
    let value = value + 0.0;
    let magnitude = if value == 0.0 { 0.0 } else { value.abs().log10().floor() };
    if !(-5.0..15.0).contains(&magnitude) {
        write!(text, "{value:.*e}", DIGITS as usize - 1).expect("a vector takes all");
        return;
    }
    let decimals = (DIGITS - 1 - magnitude as i32).max(0);
    write!(text, "{value:.*}", decimals as usize).expect("a vector takes all");
    if decimals > 0 {
        let zeros = text.iter().rev().take_while(|&&digit| digit == b'0').count();
        text.truncate(text.len() - zeros);
        text.pop_if(|last| *last == b'.');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_nine_digits_whatever_their_sign() {
        for (value, expected) in [
            (0.0, "0"),
            (-0.0, "0"),
            (0.25, "0.25"),
            (-0.420_356_397_362_193_5, "-0.420356397"),
            (-0.034_092_282_908_518, "-0.0340922829"),
            (1_234.567_891_23, "1234.56789"),
            (-8.8e-17, "-8.80000000e-17"),
            (2e20, "2.00000000e20"),
        ] {
            let mut text = Vec::new();
            write_number(&mut text, value);
            assert_eq!(String::from_utf8_lossy(&text), expected);
        }
    }
}

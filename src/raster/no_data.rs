//! The number that stands for no data.

use std::fmt;

/// The value of cells where nothing is known, or not a number.
#[derive(Debug, Clone, Copy)]
pub struct NoData(pub f32);

impl Default for NoData {
    fn default() -> Self {
        NoData(-9999.0)
    }
}

impl NoData {
    /// What is written for a value, of which NaN says that nothing is known. A value that is this number by chance becomes the
    /// next one, which a cell can keep apart from it.
    #[inline]
    #[must_use]
    pub fn stored(self, value: f32) -> f32 {
        if value.is_nan() {
            self.0
        } else if value == self.0 {
            value.next_up()
        } else {
            value
        }
    }

    /// The value that was written as a number.
    #[inline]
    #[must_use]
    pub fn known(self, stored: f32) -> f32 {
        if stored == self.0 { f32::NAN } else { stored }
    }
}

impl fmt::Display for NoData {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_nan() { f.write_str("nan") } else { write!(f, "{}", self.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_never_taken_for_no_data() {
        for number in [-9999.0, 0.0, -0.0, f32::MAX, f32::NAN] {
            let no_data = NoData(number);
            for value in [-9999.0, 0.0, -0.0, 1.5, -f32::MAX] {
                let known = no_data.known(no_data.stored(value));
                assert!((known - value).abs() <= 1e-3, "{value} with {no_data}");
            }
            assert!(no_data.known(no_data.stored(f32::NAN)).is_nan());
        }
    }
}

//! The number that marks cells without data.

use std::fmt;

/// The value of cells without data. May be NaN.
#[derive(Debug, Clone, Copy)]
pub struct NoData(pub f32);

impl Default for NoData {
    fn default() -> Self {
        NoData(-9999.0)
    }
}

impl NoData {
    /// The number written for a value; NaN means no data. A value that equals the no-data number, or is so
    /// near that programs take it for that number (GDAL: a relative difference below `4.0 * f32::EPSILON`),
    /// is moved away from it.
    #[inline]
    pub fn stored(self, value: f32) -> f32 {
        if value.is_nan() {
            self.0
        } else if (value - self.0).abs() < self.room() {
            // A value that equals the number moves towards zero, so that it stays in range.
            let sign = if value == self.0 { -self.0 } else { value - self.0 };
            self.0 + self.room().copysign(sign)
        } else {
            value
        }
    }

    /// Least distance of values from the number: 16 units in its last place.
    fn room(self) -> f32 {
        16.0 * (self.0.abs() - self.0.abs().next_down())
    }

    /// The value of a stored number; NaN if the number means no data.
    #[inline]
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
                assert!((known - value).abs() <= 2e-6 * value.abs() + 1e-40, "{value} with {no_data}");
                // As GDAL compares numbers.
                let stored = no_data.stored(value);
                let near = 2.0 * f32::EPSILON * (0.5 * stored + 0.5 * number).abs() * 2.0;
                assert!(
                    number.is_nan() || (0.5 * stored - 0.5 * number).abs() >= 0.5 * near,
                    "{value} with {no_data}"
                );
                assert!(stored != number);
            }
            assert!(no_data.known(no_data.stored(f32::NAN)).is_nan());
        }
    }
}

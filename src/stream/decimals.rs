//! World coordinates of grid points as people write them: 28016 steps of 0.001 are 28.016.

/// Powers of ten that f64 represents exactly.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

/// 2^53: all integers below are f64.
const INTEGER_MAX: f64 = 9_007_199_254_740_992.0;

/// Decimals that most scales and offsets do with.
const USUAL_DECIMALS: usize = 3;

/// Digits with which any f64 reads back.
const DIGITS_MAX: usize = 17;

/// One axis of a grid: world = stored * scale + offset.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axis {
    pub(super) scale: f64,
    pub(super) offset: f64,
}

impl Axis {
    /// The world coordinate of a stored one, in f64.
    #[inline]
    pub(super) fn world(self, stored: f64) -> f64 {
        stored * self.scale + self.offset
    }

    /// The number with the shortest decimal that stands for a stored coordinate: of the numbers that are as
    /// close to [`Axis::world`] as rounding allows, and that are next to the stored coordinate on the grid, the
    /// one with the fewest significant digits; of several, the closest.
    ///
    /// Scale and offset stand for decimals, from which they differ by half a unit in their last place. So do
    /// product and sum, and the decimal that is sought. The tolerance is the sum of all that.
    #[inline]
    pub(super) fn decimal(self, stored: f64) -> f64 {
        let world = self.world(stored);
        let tolerance = self.tolerance(stored);
        let admits_one = |power: f64| (world * power).abs() < INTEGER_MAX && tolerance * power < 0.25;
        // Where the tolerance admits one multiple of 1/power at most, a coarser one is the same number. So what
        // fails for millimetres need not be tried for metres.
        let first = if admits_one(POWERS[USUAL_DECIMALS]) { USUAL_DECIMALS } else { 0 };
        for &power in POWERS[first..].iter().take_while(|&&power| admits_one(power)) {
            let number = nearest_integer(world * power) / power;
            if self.stands_for(number, stored, world, tolerance) {
                // Zero has no sign here.
                return number + 0.0;
            }
        }
        self.search(stored, world, tolerance)
    }

    /// Whether a number, which a decimal was read as, stands for the stored coordinate.
    #[inline]
    pub(super) fn is_decimal_of(self, number: f64, stored: f64) -> bool {
        self.stands_for(number, stored, self.world(stored), self.tolerance(stored))
    }

    /// As [`Axis::decimal`], by bisection of the number of digits: more of them are closer.
    fn search(self, stored: f64, world: f64, tolerance: f64) -> f64 {
        let rounded = |digits: usize| format!("{world:.*e}", digits - 1).parse().unwrap_or(world);
        let is_short = |digits: usize| self.stands_for(rounded(digits), stored, world, tolerance);
        let (mut few, mut enough) = (0, DIGITS_MAX);
        while few + 1 < enough {
            let digits = usize::midpoint(few, enough);
            *if is_short(digits) { &mut enough } else { &mut few } = digits;
        }
        // Numbers next to the tolerance may be rounded across it.
        while let Some(digits) = (1..enough).rev().take(2).find(|&digits| is_short(digits)) {
            enough = digits;
        }
        rounded(enough) + 0.0
    }

    #[inline]
    fn tolerance(self, stored: f64) -> f64 {
        ((stored * self.scale).abs() + self.offset.abs()) * (2.0 * f64::EPSILON)
    }

    #[inline]
    fn stands_for(self, number: f64, stored: f64, world: f64, tolerance: f64) -> bool {
        (number - world).abs() <= tolerance && ((number - self.offset) / self.scale - stored).abs() < 0.5
    }
}

/// An integer next to a number below 2^53; of two, either. (The library function is a call on many machines.)
#[inline]
fn nearest_integer(number: f64) -> f64 {
    (number + 0.5f64.copysign(number)) as i64 as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCALES: [f64; 8] = [0.001, 0.01, 0.0001, 0.25, 1e-7, 1.0 / 3.0, 0.3048, 1e6];

    /// Integers over the whole range of i32: its ends, near zero, and in between.
    fn integers() -> impl Iterator<Item = f64> {
        let mut state = 1u64;
        let ends = [i32::MIN, i32::MIN + 1, -1, 0, 1, 28_016, i32::MAX - 1, i32::MAX];
        let random = std::iter::repeat_with(move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 32) as i32
        });
        ends.into_iter().chain(-500..500).chain(random.take(3000)).map(f64::from)
    }

    /// Offsets up to the greatest that a stream may have.
    fn offsets(scale: f64) -> Vec<f64> {
        let most = scale * 2f64.powi(51);
        let all =
            [0.0, -0.05, 0.1, 300_000.0, 5_000_000.25, -4_321_987.65, -1e9, 1e12, most, -most, most / 3.0];
        all.into_iter().filter(|offset| offset.abs() <= most).collect()
    }

    #[test]
    fn every_integer_reads_back_from_its_decimal() {
        for scale in SCALES {
            for offset in offsets(scale) {
                let axis = Axis { scale, offset };
                for stored in integers() {
                    let number = axis.decimal(stored);
                    let read: f64 = number.to_string().parse().unwrap();
                    assert_eq!(((read - offset) / scale).round(), stored, "{scale} {offset}");
                    assert!(axis.is_decimal_of(read, stored), "{scale} {offset} {stored}");
                    assert!(axis.is_decimal_of(axis.world(stored), stored), "{scale} {offset} {stored}");
                }
            }
        }
    }

    /// The same by definition, digit by digit.
    #[test]
    fn no_number_with_fewer_digits_stands_for_it() {
        for scale in SCALES {
            for offset in offsets(scale) {
                let axis = Axis { scale, offset };
                for stored in integers().step_by(7) {
                    let number = axis.decimal(stored);
                    let world = axis.world(stored);
                    let rounded = |digits: usize| format!("{world:.*e}", digits - 1).parse::<f64>().unwrap();
                    let mut all = (1..=DIGITS_MAX).map(rounded);
                    let least = all.find(|&number| axis.is_decimal_of(number, stored)).unwrap();
                    assert_eq!(number, least, "{scale} {offset} {stored}");
                    assert!(number != 0.0 || number.is_sign_positive(), "{scale} {offset} {stored}");
                }
            }
        }
    }

    #[test]
    fn multiples_of_decimals_are_those_that_people_mean() {
        let text = |scale, offset, stored: i32| Axis { scale, offset }.decimal(f64::from(stored)).to_string();
        assert_eq!(28_016.0 * 0.001, 28.016_000_000_000_002);
        assert_eq!(text(0.001, 0.0, 28_016), "28.016");
        assert_eq!(text(0.001, 300_000.0, -27_999), "299972.001");
        assert_eq!(text(0.01, 500_000.0, -49_999_899), "1.01");
        assert_eq!(text(0.01, 500_000.0, -50_000_000), "0");
        assert_eq!(text(0.01, -4_321_987.65, 432_198_765), "0");
        assert_eq!(text(1e-7, 123_456.7, 1), "123456.7000001");
        assert_eq!(text(0.25, 0.1, 3), "0.85");
        assert_eq!(text(1.0 / 3.0, 0.0, 3), "1");
        assert_eq!(text(1.0 / 3.0, 0.0, 1), "0.3333333333333333");
        assert_eq!(text(1e6, 0.0, i32::MAX), "2147483647000000");
        for stored in (-40_000..40_000).chain([i32::MIN, i32::MAX]) {
            // Decimal arithmetic on integers.
            let thousandths = i64::from(stored) - 4_321_987_650;
            let digits = format!("{}.{:03}", thousandths.abs() / 1000, thousandths.abs() % 1000);
            let expected = digits.trim_end_matches('0').trim_end_matches('.');
            let sign = if thousandths < 0 { "-" } else { "" };
            assert_eq!(text(0.001, -4_321_987.65, stored), format!("{sign}{expected}"));
        }
    }

    #[test]
    fn other_numbers_do_not_stand_for_a_stored_coordinate() {
        let axis = Axis { scale: 0.001, offset: 300_000.0 };
        for (number, stored) in
            [(300_000.000_5, 0.0), (300_000.000_5, 1.0), (300_000.001, 0.0), (300_000.001_1, 1.0)]
        {
            assert!(!axis.is_decimal_of(number, stored), "{number}");
        }
        assert!(axis.is_decimal_of(300_000.001, 1.0));
    }

    /// Sides of regions need not lie on the grid, and may be infinite.
    #[test]
    fn numbers_off_the_grid_have_decimals_too() {
        let axis = Axis { scale: 0.001, offset: 0.1 };
        assert_eq!(axis.decimal((50.0 - 0.1) / 0.001), 50.0);
        assert_eq!(axis.decimal(f64::INFINITY), f64::INFINITY);
        assert_eq!(axis.decimal(f64::NEG_INFINITY), f64::NEG_INFINITY);
    }
}

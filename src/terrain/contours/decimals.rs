//! Multiples of a decimal as people mean them: three times 0.1 is 0.3.

use spmesh_stream::model::decimal::digits;

/// The greatest power of ten that f64 represents exactly.
const POWER_MAX: i32 = 22;

/// Limits on step and base, so that `base + k * step` fits in 128 bits.
const STEP_MAX: i128 = 1 << 60;
const BASE_MAX: i128 = 1 << 120;

/// `base + k * step` for integers k, nondecreasing in k for a positive step.
///
/// Base and step stand for the shortest decimals that denote them, as people and files write them. If these
/// have few digits, the sum is computed in decimals and rounded once, to the nearest f64 if it has at most 15
/// digits. Otherwise it is computed in f64.
#[derive(Debug, Clone, Copy)]
pub(super) struct Decimals {
    base: f64,
    step: f64,
    exact: Option<Exact>,
}

/// Base and step as integer multiples of 1 / `units`.
#[derive(Debug, Clone, Copy)]
struct Exact {
    base: i128,
    step: i128,
    units: f64,
}

impl Decimals {
    /// Multiples of `step / 10^finer`, from `base` on.
    ///
    /// Domain: finite numbers.
    pub(super) fn new(base: f64, step: f64, finer: i32) -> Decimals {
        Decimals { base, step: step / 10f64.powi(finer), exact: Exact::of(base, step, finer) }
    }

    /// The number at place `k`. Domain: |k| at most 2^53.
    #[inline]
    pub(super) fn at(&self, k: i64) -> f64 {
        match self.exact {
            Some(Exact { base, step, units }) => {
                let sum = base + step * i128::from(k);
                // Processors convert 64 bits, but not 128.
                i64::try_from(sum).map_or_else(|_| sum as f64, |sum| sum as f64) / units
            }
            None => self.base + self.step * k as f64,
        }
    }
}

impl Exact {
    /// `None` if there are too many digits.
    fn of(base: f64, step: f64, finer: i32) -> Option<Exact> {
        let ((base, base_power), (step, step_power)) = (digits(base)?, digits(step)?);
        let step_power = step_power - finer;
        let power = base_power.min(step_power).min(0);
        let shifted = |digits: i128, from: i32| {
            10i128.checked_pow((from - power) as u32).and_then(|factor| digits.checked_mul(factor))
        };
        let base = shifted(base, base_power).filter(|base| base.abs() < BASE_MAX)?;
        let step = shifted(step, step_power).filter(|step| step.abs() < STEP_MAX)?;
        (-power <= POWER_MAX).then(|| Exact { base, step, units: 10f64.powi(-power) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn multiples_are_the_decimals_that_people_mean() {
        for (base, step, finer) in
            [(0.0, 0.1, 0), (0.05, 0.1, 0), (-1234.5, 0.01, 2), (7.0, 25.0, 0), (0.0, 2.5e-7, 0)]
        {
            let decimals = Decimals::new(base, step, finer);
            let parsed = |text: String| text.parse::<f64>().unwrap();
            for k in -4000..4000 {
                // In units of 10^-10, which all of these are multiples of.
                let [base, step] = [base, step].map(|value: f64| (value * 1e10).round() as i64);
                let expected = parsed(format!("{}e-10", base + k * step / 10i64.pow(finer as u32)));
                assert_eq!(decimals.at(k), expected, "{base} {step} {finer} {k}");
            }
        }
        assert_eq!(Decimals::new(0.0, 0.1, 0).at(3), 0.3);
    }

    #[test]
    fn long_numbers_are_multiplied_plainly() {
        for (base, step) in [(0.0, 1.0 / 3.0 * 1e-9), (1e300, 1.0), (0.0, 5e-324), (1e-30, 1e-3)] {
            let decimals = Decimals::new(base, step, 0);
            assert!(decimals.exact.is_none(), "{base} {step}");
            assert_eq!(decimals.at(7), base + 7.0 * step);
        }
        assert_eq!(Decimals::new(0.0, 1e17, 0).at(1 << 53), 2f64.powi(53) * 1e17);
    }

    #[test]
    fn numbers_never_decrease() {
        for (base, step) in [(0.1, 1e-17), (1e9, 1e-7), (0.3, 1.0 / 3.0), (1e22, 123.456)] {
            let decimals = Decimals::new(base, step, 0);
            for near in [-(1i64 << 52), -1000, 0, 1 << 52] {
                let values: Vec<f64> = (near..near + 3000).map(|k| decimals.at(k)).collect();
                assert!(values.windows(2).all(|pair| pair[0] <= pair[1]), "{base} {step} {near}");
            }
        }
    }
}

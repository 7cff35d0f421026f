//! Medians and other quantiles of magnitudes, from one pass, in a fixed amount of memory.

/// Number of bits, below the sign, that determine the class of a number: 11 of the exponent, 7 of the
/// fraction.
const CLASS_BITS: u32 = 18;
/// Bits below the class bits.
const SHIFT: u32 = 63 - CLASS_BITS;

/// Counts of magnitudes in classes of equal relative width. Memory: 2 MB.
#[derive(Debug, Clone)]
pub struct QuantileSketch {
    counts: Vec<u64>,
    total: u64,
}

impl Default for QuantileSketch {
    fn default() -> QuantileSketch {
        QuantileSketch { counts: vec![0; 1 << CLASS_BITS], total: 0 }
    }
}

impl QuantileSketch {
    /// Counts a finite number by its magnitude.
    pub fn add(&mut self, number: f64) {
        self.counts[(number.abs().to_bits() >> SHIFT) as usize] += 1;
        self.total += 1;
    }

    /// The lower median of magnitudes. Accuracy: as [`QuantileSketch::quantile`].
    pub fn median(&self) -> Option<f64> {
        self.quantile(0.5)
    }

    /// The least magnitude q such that `part` of all magnitudes are at most q. It is rounded to the middle of
    /// its class, at most half a percent off. `None` without numbers.
    ///
    /// Domain: 0 < `part` <= 1.
    pub fn quantile(&self, part: f64) -> Option<f64> {
        let enough = (part * self.total as f64).ceil() as u64;
        let mut below = 0;
        let is_reached = |count: &u64| {
            below += count;
            below >= enough
        };
        let class = self.counts.iter().position(is_reached).filter(|_| self.total > 0)? as u64;
        // In practice zero is the only number of its class, and for exact data it is the only residual.
        let middle = if class == 0 { 0 } else { 1 << (SHIFT - 1) };
        Some(f64::from_bits((class << SHIFT) + middle))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_base::random::Random;

    #[test]
    fn medians_are_half_a_percent_off_at_most() {
        let mut random = Random::new(4);
        for count in [1, 2, 3, 10, 1001] {
            let mut all: Vec<f64> =
                (0..count).map(|_| random.bits() as f64 * 2f64.powi(random.below(90) as i32 - 100)).collect();
            let mut sketch = QuantileSketch::default();
            all.iter().enumerate().for_each(|(i, &x)| sketch.add(if i % 2 == 0 { x } else { -x }));
            all.sort_by(f64::total_cmp);
            let expected = all[(count - 1) / 2];
            let found = sketch.median().unwrap();
            assert!((found / expected - 1.0).abs() < 0.005, "{count}: {found}, {expected}");
            for (part, at) in [(0.95, (95 * count).div_ceil(100) - 1), (1.0, count - 1)] {
                let (expected, found) = (all[at], sketch.quantile(part).unwrap());
                assert!((found / expected - 1.0).abs() < 0.005, "{count} {part}: {found}, {expected}");
            }
        }
        assert_eq!(QuantileSketch::default().median(), None);
        let mut zeros = QuantileSketch::default();
        [0.0, -0.0, 5.0].iter().for_each(|&x| zeros.add(x));
        assert_eq!(zeros.median(), Some(0.0));
    }
}

//! The range of values that colours span.

/// Most samples that percentiles are taken of.
const SAMPLES_MAX: usize = 1 << 18;

/// The percentiles of weighted values: the least values that, with all lesser ones, have these parts of the weight.
/// `None` if there is no weight, or both are the same value.
pub(super) fn percentiles(values: impl Iterator<Item = (f64, f64)>, percents: [f64; 2]) -> Option<[f64; 2]> {
    let mut values: Vec<(f64, f64)> =
        values.filter(|(value, weight)| value.is_finite() && weight.is_finite()).collect();
    values.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let total: f64 = values.iter().map(|(_, weight)| weight).sum();
    let at = |percent: f64| {
        let mut sum = 0.0;
        let found = values.iter().find(|(_, weight)| {
            sum += weight;
            sum >= total * percent / 100.0 && sum > 0.0
        });
        // Rounding may leave the sum below the total.
        found.or(values.last()).map(|(value, _)| *value)
    };
    let [low, high] = percents.map(at);
    low.zip(high).filter(|(low, high)| low < high).map(|(low, high)| [low, high])
}

/// Evenly spaced ones of many values.
pub(super) fn some_of(values: &[f64]) -> impl Iterator<Item = f64> + '_ {
    values.iter().copied().step_by(values.len().div_ceil(SAMPLES_MAX).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_count_weights() {
        let hundred = || (1..=100).rev().map(|value| (f64::from(value), 1.0));
        assert_eq!(percentiles(hundred(), [2.0, 98.0]), Some([2.0, 98.0]));
        assert_eq!(percentiles(hundred(), [0.0, 100.0]), Some([1.0, 100.0]));
        let heavy = [(7.0, 1.0), (5.0, 98.0), (f64::NAN, 9.0), (6.0, 1.0)];
        assert_eq!(percentiles(heavy.into_iter(), [2.0, 98.0]), None);
        assert_eq!(percentiles(heavy.into_iter(), [2.0, 98.5]), Some([5.0, 6.0]));
        assert_eq!(percentiles(std::iter::empty(), [2.0, 98.0]), None);
    }
}

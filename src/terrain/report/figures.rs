//! What differences are like.

/// Scales the median of absolute deviations so that it is the standard deviation of normal errors.
///
/// Source: Höhle and Höhle, "Accuracy assessment of digital elevation models by means of robust statistical
/// methods", ISPRS Journal 64 (2009), section 3.2.
const NMAD: f64 = 1.4826;

/// Figures of some differences, at least one.
#[derive(Debug, Clone, PartialEq)]
pub struct Figures {
    /// How many there are.
    pub count: u64,
    /// Their mean: the bias.
    pub mean: f64,
    /// Their median.
    pub median: f64,
    /// Their standard deviation, with one degree of freedom less than there are; `None` of one.
    pub deviation: Option<f64>,
    /// The root of their mean square.
    pub rmse: f64,
    /// The normalized median of absolute deviations from the median.
    pub nmad: f64,
    /// The 95th percentile of their absolute values.
    pub percentile95: f64,
    /// The least.
    pub min: f64,
    /// The greatest.
    pub max: f64,
    /// Third moment about the mean, over the cube of the root of the second; `None` if all are the same.
    pub skewness: Option<f64>,
}

impl Figures {
    /// The figures of differences, which are no NaN; `None` if there are none.
    pub fn of(mut differences: Vec<f64>) -> Option<Figures> {
        // In one order, so that the order of points does not matter for roundings.
        differences.sort_unstable_by(f64::total_cmp);
        let (min, max) = (*differences.first()?, *differences.last()?);
        let count = differences.len() as f64;
        let mean_of = |power: i32, from: f64| {
            differences.iter().map(|difference| (difference - from).powi(power)).sum::<f64>() / count
        };
        let mean = mean_of(1, 0.0);
        let (second, third) = (mean_of(2, mean), mean_of(3, mean));
        let median = percentile(&differences, 50.0);
        let (rmse, spread) = (mean_of(2, 0.0).sqrt(), second.sqrt());
        let sorted = |from: f64| {
            let mut sizes: Vec<f64> =
                differences.iter().map(|difference| (difference - from).abs()).collect();
            sizes.sort_unstable_by(f64::total_cmp);
            sizes
        };
        Some(Figures {
            count: differences.len() as u64,
            mean,
            median,
            deviation: (count > 1.0).then(|| (second * count / (count - 1.0)).sqrt()),
            rmse,
            nmad: NMAD * percentile(&sorted(median), 50.0),
            percentile95: percentile(&sorted(0.0), 95.0),
            min,
            max,
            skewness: (max > min).then(|| third / spread.powi(3)),
        })
    }
}

/// The percentile of ascending values, of which there is one at least: linear between the two next to its
/// place, as numpy's.
pub(super) fn percentile(sorted: &[f64], percent: f64) -> f64 {
    let place = percent / 100.0 * (sorted.len() - 1) as f64;
    let below = (place as usize).min(sorted.len() - 1);
    let (low, high) = (sorted[below], sorted[(below + 1).min(sorted.len() - 1)]);
    low + (high - low) * (place - below as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_differences_have_figures() {
        assert_eq!(Figures::of(Vec::new()), None);
        let one = Figures::of(vec![-2.0]).unwrap();
        assert_eq!((one.mean, one.rmse, one.nmad, one.percentile95), (-2.0, 2.0, 0.0, 2.0));
        assert_eq!((one.deviation, one.skewness), (None, None));
        let same = Figures::of(vec![1.0; 3]).unwrap();
        assert_eq!((same.deviation, same.skewness, same.median), (Some(0.0), None, 1.0));
    }

    #[test]
    fn figures_are_those_of_their_definitions() {
        let four = Figures::of(vec![3.0, -1.0, 0.0, 4.0]).unwrap();
        assert_eq!((four.mean, four.median, four.rmse), (1.5, 1.5, 6.5f64.sqrt()));
        assert_eq!(four.nmad, NMAD * 2.0);
        assert!((four.percentile95 - 3.85).abs() < 1e-12);
        assert!((four.deviation.unwrap() - (17.0f64 / 3.0).sqrt()).abs() < 1e-12);
        let lop = Figures::of(vec![0.0, 0.0, 0.0, 4.0]).unwrap();
        assert!((lop.skewness.unwrap() - 6.0 / 3.0f64.powf(1.5)).abs() < 1e-12);
    }
}

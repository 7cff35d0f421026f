//! Statistics of the numbers in cells, as GDAL keeps them.

/// Count, range, mean and sum of squared deviations from it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Statistics {
    count: u64,
    least: f64,
    greatest: f64,
    mean: f64,
    deviations: f64,
}

impl Statistics {
    /// Of some numbers; `None` if there are none.
    pub(super) fn of(numbers: &[f64]) -> Option<Statistics> {
        let count = numbers.len() as u64;
        let mean = numbers.iter().sum::<f64>() / count as f64;
        let (mut least, mut greatest, mut deviations) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
        for &number in numbers {
            (least, greatest) = (least.min(number), greatest.max(number));
            deviations += (number - mean) * (number - mean);
        }
        (count > 0).then_some(Statistics { count, least, greatest, mean, deviations })
    }

    /// Of the numbers of both.
    ///
    /// Source: Chan, Golub and LeVeque, "Updating formulae and a pairwise algorithm for computing sample
    /// variances", 1979.
    pub(super) fn and(self, other: Statistics) -> Statistics {
        let count = self.count + other.count;
        let (part, difference) = (other.count as f64 / count as f64, other.mean - self.mean);
        Statistics {
            count,
            least: self.least.min(other.least),
            greatest: self.greatest.max(other.greatest),
            mean: self.mean + difference * part,
            deviations: self.deviations
                + other.deviations
                + difference * difference * part * self.count as f64,
        }
    }

    /// Names and values of items of GDAL's metadata; `cells` is the number of all cells.
    pub(super) fn items(&self, cells: u64) -> [(&'static str, f64); 5] {
        [
            ("STATISTICS_MAXIMUM", self.greatest),
            ("STATISTICS_MEAN", self.mean),
            ("STATISTICS_MINIMUM", self.least),
            ("STATISTICS_STDDEV", (self.deviations / self.count as f64).sqrt()),
            ("STATISTICS_VALID_PERCENT", 100.0 * self.count as f64 / cells as f64),
        ]
    }
}

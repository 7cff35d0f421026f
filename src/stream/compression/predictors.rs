//! Predictors of coordinates: what a coordinate differs from its prediction is small.

use super::columns::{bit_length, unzigzag, zigzag};

/// Differences that the median is of.
const WINDOW: usize = 5;
/// The encoder tries both predictors on runs of this length, about `SAMPLES` of them.
const RUN: usize = 256;
const SAMPLES: usize = 8;
/// Residuals at the start of a run that do not count: the window is filling.
const WARM_UP: usize = 8;

/// How a coordinate is predicted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Predictor {
    /// By the one before.
    Previous,
    /// By the one before and the median of the last five differences.
    Median,
}

impl Predictor {
    pub(super) fn of_byte(byte: u8) -> Option<Predictor> {
        match byte {
            0 => Some(Predictor::Previous),
            1 => Some(Predictor::Median),
            _ => None,
        }
    }

    pub(super) fn byte(self) -> u8 {
        match self {
            Predictor::Previous => 0,
            Predictor::Median => 1,
        }
    }

    /// The predictor with the shorter residuals, judged by a sample, and its residuals.
    pub(super) fn choose(coordinates: &[i32]) -> (Predictor, Vec<u32>) {
        let previous = residuals_to_previous(coordinates);
        let (mut previous_len, mut median_len) = (0, 0);
        let step = (coordinates.len() / SAMPLES).max(RUN);
        for start in (0..coordinates.len().saturating_sub(1)).step_by(step) {
            let run = start..(start + RUN + WARM_UP).min(coordinates.len());
            previous_len += bits(&previous[run.clone()]);
            median_len += bits(&residuals_to_median(&coordinates[run]));
        }
        // The median costs time: it must save a sixteenth.
        if median_len * 16 < previous_len * 15 {
            return (Predictor::Median, residuals_to_median(coordinates));
        }
        (Predictor::Previous, previous)
    }

    /// Calls `put` with each coordinate, given the first one and all residuals.
    pub(super) fn restore(self, first: i32, residuals: &[u32], mut put: impl FnMut(usize, i32)) {
        let (mut at, mut window) = (first, [0; WINDOW]);
        for (index, &residual) in residuals.iter().enumerate() {
            let mut difference = unzigzag(residual);
            if self == Predictor::Median {
                difference = difference.wrapping_add(median(window));
                shift(&mut window, difference);
            }
            at = at.wrapping_add(difference);
            put(index, at);
        }
    }
}

fn residuals_to_previous(coordinates: &[i32]) -> Vec<u32> {
    let mut before = coordinates[0];
    let residual = |&at: &i32| zigzag(at.wrapping_sub(std::mem::replace(&mut before, at)));
    coordinates.iter().map(residual).collect()
}

fn residuals_to_median(coordinates: &[i32]) -> Vec<u32> {
    let (mut before, mut window) = (coordinates[0], [0; WINDOW]);
    let residual = |&at: &i32| {
        let difference = at.wrapping_sub(std::mem::replace(&mut before, at));
        let residual = zigzag(difference.wrapping_sub(median(window)));
        shift(&mut window, difference);
        residual
    };
    coordinates.iter().map(residual).collect()
}

/// Length of the residuals after the first few, in bits.
fn bits(residuals: &[u32]) -> u64 {
    residuals.iter().skip(WARM_UP).map(|&residual| u64::from(bit_length(residual))).sum()
}

fn shift(window: &mut [i32; WINDOW], difference: i32) {
    let [_, b, c, d, e] = *window;
    *window = [b, c, d, e, difference];
}

/// The median of five numbers, by comparisons that need no branches.
fn median([a, b, c, d, e]: [i32; WINDOW]) -> i32 {
    let low = a.min(b).max(c.min(d));
    let high = a.max(b).min(c.max(d));
    low.min(high).max(low.max(high).min(e))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_third_of_five() {
        for code in 0..5i32.pow(5) {
            let numbers: [i32; 5] = std::array::from_fn(|digit| code / 5i32.pow(digit as u32) % 5);
            let mut sorted = numbers;
            sorted.sort_unstable();
            assert_eq!(median(numbers), sorted[2], "{numbers:?}");
        }
    }

    #[test]
    fn coordinates_come_back() {
        let wild = [0, i32::MAX, i32::MIN, -1, 7, i32::MIN, i32::MIN, i32::MAX, 5];
        let steady: Vec<i32> = (0..4000).map(|i| 37 * i + i % 3).collect();
        for coordinates in [&wild[..], &steady, &[9]] {
            let (chosen, residuals) = Predictor::choose(coordinates);
            let median = (Predictor::Median, residuals_to_median(coordinates));
            for (predictor, residuals) in [(chosen, residuals), median] {
                let mut restored = vec![0; coordinates.len()];
                predictor.restore(coordinates[0], &residuals, |index, at| restored[index] = at);
                assert_eq!(restored, coordinates);
            }
        }
        assert_eq!(Predictor::choose(&steady).0, Predictor::Median);
    }
}

//! Search for the first index at which a monotone predicate holds.

use std::ops::Range;

/// The first index of a range at which a monotone predicate holds; the end of the range if it holds nowhere.
///
/// Cost: two calls if the guess is right; otherwise logarithmic in its error. The guess may be NaN.
#[inline]
pub(super) fn first(range: Range<u32>, guess: f64, mut holds: impl FnMut(u32) -> bool) -> u32 {
    let Range { mut start, mut end } = range;
    // Rounded up. The conversion turns NaN into zero, and saturates.
    let below = guess as u32;
    let (mut probe, mut stride) = (f64::from(below) + if f64::from(below) < guess { 1.0 } else { 0.0 }, 1.0);
    while start < end {
        // Where the probe leaves the range, bisection takes over.
        let last = end - 1;
        let at = if stride == 1.0 {
            (probe as u32).clamp(start, last)
        } else if f64::from(start) <= probe && probe <= f64::from(last) {
            probe as u32
        } else {
            start + (end - start) / 2
        };
        if holds(at) {
            end = at;
            probe = f64::from(at) - stride;
        } else {
            start = at + 1;
            probe = f64::from(at) + stride;
        }
        stride *= 2.0;
    }
    start
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_is_found_from_every_guess() {
        for (start, end) in [(0, 0), (0, 1), (3, 10), (0, 64), (u32::MAX - 9, u32::MAX)] {
            for place in start..=end {
                let guesses = (start..=end).map(f64::from);
                for guess in guesses.chain([f64::NAN, f64::INFINITY, -1e300, -0.5]) {
                    assert_eq!(first(start..end, guess, |at| at >= place), place, "{guess}");
                }
            }
        }
    }

    #[test]
    fn good_guesses_are_cheap_and_bad_ones_logarithmic() {
        let calls = |place: u32, guess: f64| {
            let mut calls = 0;
            first(0..1 << 30, guess, |at| {
                calls += 1;
                at >= place
            });
            calls
        };
        assert_eq!(calls(1_000, 999.3), 2);
        assert!(calls(1_000, 1_003.0) <= 6);
        assert!((0..40).all(|i| calls(1_000 + 7 * i, 1e9) < 80));
        assert!((0..40).all(|i| calls((1 << 30) - 7 * i, f64::NAN) < 80));
    }
}

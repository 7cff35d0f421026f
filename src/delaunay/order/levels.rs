//! Levels of points by their lowest bits.

use crate::predicates::exact_integers::decompose;

/// The highest level.
pub const BIT_LEVEL_MAX: u32 = 8;

/// The lowest bits that points of a level share.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Suffixes {
    /// On each axis the bit that most points have as their lowest, then the next above that most of those
    /// have, and so on.
    #[default]
    MostCommon,
    /// Zeros.
    Zeros,
}

/// Levels, from 0 to [`BIT_LEVEL_MAX`], of points by what their coordinates have in common with a suffix per
/// axis: a point of level k has the k lowest bits of the suffix on every axis. Differences of points of level
/// k and above are multiples of 2^k, which saves k bits of precision. (Thesis 3.4.1, "bit leveling".)
///
/// Coordinates are taken as integers in two's complement, in the greatest power of two of which all of them
/// are multiples. Where those would have more than 53 bits, suffixes are zeros, and bits are those of each
/// coordinate's own significand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BitLevels<const D: usize> {
    /// The binary logarithm of the unit of the integers.
    unit: Option<i32>,
    suffixes: [u8; D],
}

impl<const D: usize> BitLevels<D> {
    /// The levels for `points`, which are finite. Cost: two passes.
    pub fn of(points: &[[f64; D]], suffixes: Suffixes) -> BitLevels<D> {
        let unit = common_unit(points);
        let suffixes = match (unit, suffixes) {
            (Some(unit), Suffixes::MostCommon) => most_common(points, unit),
            _ => [0; D],
        };
        BitLevels { unit, suffixes }
    }

    /// The level of one of the points.
    #[inline]
    pub fn level(&self, point: [f64; D]) -> u32 {
        let different = |axis: usize| match self.unit {
            Some(unit) => lowest_bits(point[axis], unit) ^ self.suffixes[axis],
            None => point[axis].to_bits() as u8,
        };
        let different = (0..D).fold(1 << BIT_LEVEL_MAX, |bits, axis| bits | u32::from(different(axis)));
        different.trailing_zeros()
    }
}

/// Significand and exponent: the magnitude of `number` is `m * 2^e`.
#[inline]
fn parts(number: f64) -> (u64, i32) {
    let (significand, exponent) = decompose(number);
    (significand.unsigned_abs(), exponent)
}

/// Logarithm of the greatest power of two of which all coordinates are multiples, if those have at most 53
/// bits.
fn common_unit<const D: usize>(points: &[[f64; D]]) -> Option<i32> {
    let (mut least, mut greatest) = (i32::MAX, i32::MIN);
    for (significand, exponent) in points.as_flattened().iter().map(|&number| parts(number)) {
        if significand != 0 {
            least = least.min(exponent + significand.trailing_zeros() as i32);
            greatest = greatest.max(exponent + significand.ilog2() as i32);
        }
    }
    if least > greatest {
        return Some(0);
    }
    (greatest - least < f64::MANTISSA_DIGITS as i32).then_some(least)
}

/// The lowest bits of an integer, in two's complement, of the given unit, of at most 53 bits.
#[inline]
fn lowest_bits(number: f64, unit: i32) -> u8 {
    let (significand, exponent) = parts(number);
    // Exact: the exponent is that of the last bit of 53, or the least of all.
    let magnitude = significand.checked_shr((unit - exponent) as u32).unwrap_or(0) as u8;
    if number < 0.0 { magnitude.wrapping_neg() } else { magnitude }
}

/// On each axis, the suffix each bit of which is the more common one among the numbers with the bits below.
fn most_common<const D: usize>(points: &[[f64; D]], unit: i32) -> [u8; D] {
    let mut histograms = [[0u32; 1 << BIT_LEVEL_MAX]; D];
    for point in points {
        for (histogram, &number) in histograms.iter_mut().zip(point) {
            histogram[usize::from(lowest_bits(number, unit))] += 1;
        }
    }
    histograms.map(|histogram| {
        let mut suffix = 0;
        for bit in 0..BIT_LEVEL_MAX {
            let ending = |suffix: usize| histogram[suffix..].iter().step_by(2 << bit).map(|&n| u64::from(n));
            let with_one = suffix | 1 << bit;
            if ending(with_one).sum::<u64>() > ending(suffix).sum() {
                suffix = with_one;
            }
        }
        suffix as u8
    })
}

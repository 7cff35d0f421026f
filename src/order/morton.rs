//! Morton keys: the bits of two quantised coordinates, interleaved.

use crate::bits::spread2;
use crate::predicates::{Extent, Point2};

/// Monotone map of the coordinates of an extent to `u32`, the same scale for both axes.
///
/// Monotone means: if p is at most q on an axis, so is the cell of p at most that of q. So two points whose
/// cells differ on an axis differ on that axis, in the same direction: cells of the Morton trie are separated by
/// axis-parallel lines, exactly, whatever was rounded.
#[derive(Debug, Clone, Copy)]
pub struct Quantisation {
    lower: Point2,
    /// Halves coordinates first, where their differences would overflow.
    shrink: f64,
    scale: f64,
}

impl Quantisation {
    /// Quantisation of the points within `extent`; exact if they are integers with differences below 2^32.
    #[must_use]
    pub fn of(extent: &Extent) -> Quantisation {
        let difference = extent.max_difference();
        let shrink = if difference.is_finite() { 1.0 } else { 0.5 };
        let greatest = f64::from(u32::MAX);
        let scale = if extent.integral && difference <= greatest {
            1.0
        } else if difference.is_finite() {
            greatest / difference
        } else {
            let [x, y] = [0, 1].map(|axis| extent.upper[axis] * shrink - extent.lower[axis] * shrink);
            greatest / x.max(y)
        };
        Quantisation { lower: extent.lower.map(|bound| bound * shrink), shrink, scale }
    }

    /// Quantised coordinates of a finite point within the extent.
    ///
    /// Products, differences and the saturating conversion are monotone. If the scale overflows (an extent of
    /// subnormal size), the lower bound gives 0 * infinity, a NaN, which converts to 0, and all others saturate.
    #[inline(always)]
    #[must_use]
    pub fn cell(&self, point: Point2) -> [u32; 2] {
        [0, 1].map(|axis| ((point[axis] * self.shrink - self.lower[axis]) * self.scale) as u32)
    }

    /// Morton key of a finite point within the extent.
    #[inline(always)]
    #[must_use]
    pub fn key(&self, point: Point2) -> u64 {
        let [x, y] = self.cell(point);
        morton_key(x, y)
    }
}

/// Bits of x and y interleaved, those of x the more significant of each pair.
#[inline(always)]
#[must_use]
pub fn morton_key(x: u32, y: u32) -> u64 {
    spread2(x) << 1 | spread2(y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_interleave() {
        assert_eq!(morton_key(0b11, 0b00), 0b1010);
        assert_eq!(morton_key(0b01, 0b11), 0b0111);
        assert_eq!(morton_key(u32::MAX, 0), 0xaaaa_aaaa_aaaa_aaaa);
        assert_eq!(morton_key(u32::MAX, u32::MAX), u64::MAX);
    }

    #[test]
    fn integers_below_2_32_map_exactly() {
        let points = [[-2_147_483_648.0, 5.0], [2_147_483_647.0, 6.0], [0.0, 7.0]];
        let quantisation = Quantisation::of(&Extent::of(&points));
        assert_eq!(points.map(|p| quantisation.cell(p)), [[0, 0], [u32::MAX, 1], [1 << 31, 2]]);
    }

    #[test]
    fn quantisation_is_monotone_at_every_scale() {
        let scales = [5e-324, 1e-310, 1e-300, 1.0, 1e150, f64::MAX];
        for scale in scales {
            let line: Vec<f64> = (-20..=20).map(|i| f64::from(i) / 20.0 * scale).collect();
            let points: Vec<Point2> = line.iter().map(|&x| [x, 0.0]).collect();
            let quantisation = Quantisation::of(&Extent::of(&points));
            let cells: Vec<u32> = points.iter().map(|&p| quantisation.cell(p)[0]).collect();
            assert!(cells.is_sorted(), "{scale}: {cells:?}");
            assert_eq!(cells[0], 0);
            assert!(scale < 1e-310 || cells[40] >= u32::MAX - 1, "{scale}: {cells:?}");
        }
    }
}

//! A square of cells around points.

use super::hilbert::hilbert_key;
use crate::predicates::{Extent, Point2};

/// Most bits per axis.
pub(super) const BITS_MAX: u32 = 16;

/// Cells per point that the box of the points is divided into, about.
const CELLS_PER_POINT: f64 = 8.0;

/// `2^bits` by `2^bits` cells around an extent, of the same size on both axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cells {
    pub(super) bits: u32,
    lower: Point2,
    /// Halves coordinates first, where their differences would overflow.
    shrink: f64,
    scale: f64,
}

impl Cells {
    /// Cells for `count` points within `extent`, which has at least two different points.
    pub(super) fn of(extent: &Extent, count: usize) -> Cells {
        let shrink = if extent.max_difference().is_finite() { 1.0 } else { 0.5 };
        let side = |axis: usize| extent.upper[axis] * shrink - extent.lower[axis] * shrink;
        let (long, short) = (side(0).max(side(1)), side(0).min(side(1)));
        let wanted = CELLS_PER_POINT * count as f64 * long / short;
        let bits = if wanted < 4f64.powi(BITS_MAX as i32) {
            (wanted.log2() / 2.0).ceil().max(2.0) as u32
        } else {
            BITS_MAX
        };
        let scale = (f64::from(1u32 << bits) - 1.0) / long;
        Cells { bits, lower: extent.lower.map(|bound| bound * shrink), shrink, scale }
    }

    /// Place on the Hilbert curve of the cell of a finite point within the extent.
    ///
    /// If the scale overflows (an extent of subnormal size), the lower bound gives 0 * infinity, a NaN, which
    /// converts to 0, and all others are in the last cell.
    #[inline(always)]
    pub(super) fn key(&self, point: Point2) -> u32 {
        let last = (1 << self.bits) - 1;
        let [x, y] = [0, 1].map(|axis| ((point[axis] * self.shrink - self.lower[axis]) * self.scale) as u32);
        hilbert_key(x.min(last), y.min(last), self.bits)
    }
}

//! A square of cells around points.

use super::hilbert::hilbert_key;
use crate::predicates::{Extent, Point2};

/// Most bits per axis.
pub(super) const BITS_MAX: u32 = 16;

/// Cells per point that the box of the points is divided into, about.
const CELLS_PER_POINT: f64 = 8.0;

/// Differences below this (2^-500) are enlarged first: the scale would overflow.
const TINY: f64 = f64::from_bits((1023 - 500) << 52);

/// `2^bits` by `2^bits` cells around an extent, of the same size on both axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cells {
    pub(super) bits: u32,
    lower: Point2,
    /// A power of two that coordinates are multiplied by first, where their differences or the scale would overflow.
    unit: f64,
    scale: f64,
}

impl Cells {
    /// Cells for `count` points within `extent`, which has at least two different points.
    pub(super) fn of(extent: &Extent, count: usize) -> Cells {
        let difference = extent.max_difference();
        let unit = if !difference.is_finite() {
            0.5
        } else if difference < TINY {
            1.0 / TINY
        } else {
            1.0
        };
        let side = |axis: usize| extent.upper[axis] * unit - extent.lower[axis] * unit;
        let (long, short) = (side(0).max(side(1)), side(0).min(side(1)));
        let wanted = CELLS_PER_POINT * count as f64 * long / short;
        let bits = if wanted < 4f64.powi(BITS_MAX as i32) {
            (wanted.log2() / 2.0).ceil().max(2.0) as u32
        } else {
            BITS_MAX
        };
        let scale = (f64::from(1u32 << bits) - 1.0) / long;
        Cells { bits, lower: extent.lower.map(|bound| bound * unit), unit, scale }
    }

    /// Place on the Hilbert curve of the cell of a finite point within the extent.
    ///
    /// In a tiny extent, coordinates of the other axis may overflow if they are all the same: their difference is a
    /// NaN then, which converts to 0.
    #[inline(always)]
    pub(super) fn key(&self, point: Point2) -> u32 {
        let last = (1 << self.bits) - 1;
        let [x, y] = [0, 1].map(|axis| ((point[axis] * self.unit - self.lower[axis]) * self.scale) as u32);
        hilbert_key(x.min(last), y.min(last), self.bits)
    }
}

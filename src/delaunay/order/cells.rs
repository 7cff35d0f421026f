//! A square or a cube of cells around points.

use crate::predicates::Extent;

/// Differences below this (2^-500) are enlarged first: the scale would overflow.
const TINY: f64 = f64::from_bits((1023 - 500) << 52);

/// `2^bits` cells on each of `D` axes around an extent, of the same size on all axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cells<const D: usize> {
    pub(crate) bits: u32,
    lower: [f64; D],
    /// A power of two that coordinates are multiplied by first, where their differences or the scale would
    /// overflow.
    unit: f64,
    scale: f64,
}

impl<const D: usize> Cells<D> {
    /// Most bits per axis: places on a curve have 32 bits.
    pub(super) const BITS_MAX: u32 = u32::BITS / D as u32;

    /// Cells per point that the box of the points is divided into, at least. In space it is more because
    /// points may lie on surfaces, and because one bit more per axis makes eight times as many; a longer key
    /// costs less than more points in one cell.
    const CELLS_PER_POINT: f64 = if D == 2 { 8.0 } else { 64.0 };

    /// Cells for `count` points within `extent`, which has at least two different points.
    pub(crate) fn of(extent: &Extent<D>, count: usize) -> Cells<D> {
        let difference = extent.max_difference();
        let unit = if !difference.is_finite() {
            0.5
        } else if difference < TINY {
            1.0 / TINY
        } else {
            1.0
        };
        let sides: [f64; D] =
            std::array::from_fn(|axis| extent.upper[axis] * unit - extent.lower[axis] * unit);
        let long = sides.into_iter().fold(0.0, f64::max);
        let bits =
            bits_for(sides.map(|side| side / long), Self::CELLS_PER_POINT * count as f64, Self::BITS_MAX);
        let scale = (f64::from(1u32 << bits) - 1.0) / long;
        Cells { bits, lower: extent.lower.map(|bound| bound * unit), unit, scale }
    }

    /// The cell of a finite point within the extent.
    ///
    /// In a tiny extent, coordinates of another axis may overflow if they are all the same: their difference
    /// is a NaN then, which converts to 0.
    #[inline(always)]
    pub(crate) fn of_point(&self, point: [f64; D]) -> [u32; D] {
        let last = (1 << self.bits) - 1;
        let number = |axis| ((point[axis] * self.unit - self.lower[axis]) * self.scale) as u32;
        std::array::from_fn(|axis| last.min(number(axis)))
    }
}

/// Least bits per axis, from 2, with which a box of these sides, the longest of which is 1, has the `wanted`
/// number of cells; a side shorter than a cell is as good as one.
fn bits_for<const D: usize>(sides: [f64; D], wanted: f64, bits_max: u32) -> u32 {
    let cells =
        |bits: &u32| sides.iter().map(|side| (side * f64::from(1u32 << bits)).max(1.0)).product::<f64>();
    (2..bits_max).find(|bits| cells(bits) >= wanted).unwrap_or(bits_max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_suit_the_shape_of_the_box() {
        let million = 1e6 * Cells::<3>::CELLS_PER_POINT;
        let cases = [
            ("a cube", [1.0; 3], million, 9),
            ("a slab", [1.0, 1e-2, 1.0], million, 10),
            ("a rod", [1e-1, 1e-1, 1.0], million, 10),
            ("a plane", [1.0, 1.0, 0.0], 1e4, 7),
            ("a line", [0.0, f64::NAN, 1.0], 1e2, 7),
            ("few", [1.0; 3], 26.0, 2),
            ("very many", [1.0; 3], 1e12, 10),
        ];
        for (name, sides, wanted, bits) in cases {
            assert_eq!(bits_for(sides, wanted, Cells::<3>::BITS_MAX), bits, "{name}");
        }
        assert_eq!(bits_for([1.0, 1.0], 8e6, Cells::<2>::BITS_MAX), 12);
        assert_eq!(bits_for([1.0, 1e-9], 8e6, Cells::<2>::BITS_MAX), 16);
    }
}

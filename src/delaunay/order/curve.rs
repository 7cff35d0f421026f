//! Curves through cells on two, three or four axes.

use super::hilbert::hilbert_key;
use crate::bits::{spread2, spread3};

/// Boxes in a row of [`Curve::RowMajor`], as a power of two.
const ROW_BITS: u32 = 3;

/// A curve through all cells of a square or a cube. Those of a part of 2^k cells on each axis follow each
/// other on all but the last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Curve {
    /// From each cell to a neighbour of it (Hilbert, 1891).
    #[default]
    Hilbert,
    /// By the interleaved bits of the axes (Morton, 1966), also called Z-order.
    Morton,
    /// By the rank of the interleaved bits as a Gray code: one bit changes from cell to cell (Faloutsos,
    /// 1988).
    Gray,
    /// By the first axis, then the second, then the third: rows of 8 boxes on each axis, and in each box
    /// again.
    RowMajor,
}

impl Curve {
    /// All curves.
    pub const ALL: [Curve; 4] = [Curve::Hilbert, Curve::Morton, Curve::Gray, Curve::RowMajor];

    /// Place on the curve of a cell among `2^bits` on each of `D` axes: a number of `D * bits` bits.
    ///
    /// Domain: `D` 2, 3 or 4; `bits` at most 16, 10 or 8; numbers of cells below `2^bits`.
    #[inline(always)]
    pub fn key<const D: usize>(self, cell: [u32; D], bits: u32) -> u32 {
        match self {
            Curve::Hilbert => hilbert_key(cell, bits),
            Curve::Morton => interleaved(cell),
            Curve::Gray => gray_rank(interleaved(cell)),
            Curve::RowMajor => row_major(cell, bits),
        }
    }
}

/// Row-major order in boxes within boxes, as in thesis 3.4: rows through all cells would be far longer than
/// the space between points.
#[inline(always)]
fn row_major<const D: usize>(cell: [u32; D], bits: u32) -> u32 {
    let (mut place, mut left) = (0, bits);
    while left > 0 {
        let step = left.min(ROW_BITS);
        left -= step;
        place = cell.iter().fold(place, |place, number| place << step | number >> left & ((1 << step) - 1));
    }
    place
}

/// The bits of all axes, that of the first above that of the second, and so on.
#[inline(always)]
fn interleaved<const D: usize>(cell: [u32; D]) -> u32 {
    const { assert!(D == 2 || D == 3 || D == 4) };
    let spread = |number| match D {
        2 => spread2(number),
        3 => spread3(number),
        _ => spread2(spread2(number) as u32),
    };
    cell.iter().fold(0, |bits, &number| bits << 1 | spread(number)) as u32
}

/// The number whose Gray code is `code`: each bit is the parity of those from it upwards.
#[inline(always)]
fn gray_rank(code: u32) -> u32 {
    (0..5).fold(code, |rank, power| rank ^ rank >> (1 << power))
}

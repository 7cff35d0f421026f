//! Where the centres of columns, or of rows, are, in the coordinates that vertices are stored in.

use std::ops::Range;

use super::search::first;

/// Half a unit in the last place of one.
const ROUNDING: f64 = f64::EPSILON / 2.0;

/// The centres of cells along one axis: abscissae of columns, which grow, or ordinates of rows, which fall.
///
/// A centre is brought from the world to stored coordinates once, and rounded; then it is a point of the axis as any other, and
/// vertices stay as they are. Centres never turn back, because no step of their computation does. Back from a coordinate to the
/// *place* among centres, a number that is not whole, there is a formula with a bound for its error: where a place is farther than
/// that from whole numbers, it tells what is exactly so.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axis {
    first_side: f64,
    step: f64,
    scale: f64,
    offset: f64,
    pub(super) count: u32,
    /// Places by unit of the stored coordinate, and the place of its zero.
    slope: f64,
    zero: f64,
    /// What is in the error of all places.
    world: f64,
}

/// A number that is not known exactly.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// What was computed.
    pub(super) near: f64,
    /// How far it is off, at most.
    pub(super) error: f64,
}

impl Axis {
    /// `count` cells with sides of a length `step` (below zero, if coordinates fall) from `first_side` on, in the world; stored
    /// coordinates times `scale` plus `offset` are those of the world.
    pub(super) fn new(first_side: f64, step: f64, count: u32, scale: f64, offset: f64) -> Axis {
        let (slope, zero) = (scale / step, (offset - first_side) / step - 0.5);
        let world = (first_side.abs() + offset.abs()) / step.abs() + f64::from(count);
        Axis { first_side, step, scale, offset, count, slope, zero, world }
    }

    /// The coordinate of a centre.
    #[inline]
    pub(super) fn at(&self, cell: u32) -> f64 {
        ((self.first_side + (f64::from(cell) + 0.5) * self.step) - self.offset) / self.scale
    }

    /// The place of a stored coordinate.
    ///
    /// Error: with u = 2^-53, the slope is off by u, products and sums by u each: below 3u of the product. The place of zero is
    /// off by 3u (|offset| + |first side|) / step + u. A centre itself is off by at most 2u (count + |first side| / step) + u (its
    /// place in the world) for sums and products in the world, and by 2u of itself for difference and quotient; its place in the
    /// world is below |first side| / step + count. All that is below the bound, which has room for its own rounding.
    #[inline]
    pub(super) fn place(&self, x: f64) -> Place {
        let product = x * self.slope;
        Place { near: product + self.zero, error: 16.0 * ROUNDING * (product.abs() + self.world + 1.0) }
    }

    /// Places by unit of the stored coordinate.
    #[inline]
    pub(super) fn slope(&self) -> f64 {
        self.slope
    }

    /// The cells with centres from one coordinate to another, both included.
    #[inline]
    pub(super) fn cells(&self, from: f64, to: f64) -> Range<u32> {
        if self.step > 0.0 {
            let start = self.first_from(self.place(from), |cell| self.at(cell) >= from);
            let end = self.first_from(self.place(to), |cell| self.at(cell) > to);
            start..end
        } else {
            let start = self.first_from(self.place(to), |cell| self.at(cell) <= to);
            let end = self.first_from(self.place(from), |cell| self.at(cell) < from);
            start..end
        }
    }

    /// The first cell for which `holds`, which holds for all after a place.
    #[inline]
    fn first_from(&self, place: Place, holds: impl FnMut(u32) -> bool) -> u32 {
        place.first_cell(0..self.count).unwrap_or_else(|| first(0..self.count, place.near, holds))
    }
}

impl Place {
    /// The first cell of a range that is after this place, or its end; nothing, if a cell is too near to tell.
    #[inline]
    pub(super) fn first_cell(&self, cells: Range<u32>) -> Option<u32> {
        let (low, high) = (self.near - self.error, self.near + self.error);
        // Rounded up, which processors without an instruction for it do slowly.
        let up = |place: f64| {
            let below = place.min(f64::from(cells.end)) as u32;
            below + u32::from(f64::from(below) < place.min(f64::from(cells.end)))
        };
        let cell = up(low);
        // What is not a number is not less.
        let is_certain = low <= high && cell == up(high);
        is_certain.then(|| cell.max(cells.start))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cells by a search that looks at each one.
    fn slow(axis: &Axis, from: f64, to: f64) -> Vec<u32> {
        (0..axis.count).filter(|&cell| (from..=to).contains(&axis.at(cell))).collect()
    }

    #[test]
    fn cells_are_those_between_two_coordinates() {
        let axes = [
            Axis::new(0.0, 1.0, 20, 1.0, 0.0),
            Axis::new(20.0, -1.0, 20, 1.0, 0.0),
            Axis::new(499_990.3, 0.1, 40, 0.001, 499_000.0),
            Axis::new(4_100_010.7, -0.3, 40, 0.01, 4_000_000.0),
            // Centres that cannot be told apart.
            Axis::new(1e17, 1.0, 40, 1.0, 0.0),
        ];
        for axis in axes {
            let centers: Vec<f64> = (0..axis.count).map(|cell| axis.at(cell)).collect();
            let near = |x: f64| [x.next_down(), x, x.next_up(), x + 0.3];
            let all: Vec<f64> = centers.iter().copied().flat_map(near).collect();
            let ends = [-1e300, 1e300, f64::MAX];
            for &from in all.iter().chain(&ends) {
                for &to in all.iter().step_by(7).chain(&ends).filter(|to| **to >= from) {
                    let cells: Vec<u32> = axis.cells(from, to).collect();
                    assert_eq!(cells, slow(&axis, from, to), "{from} to {to} of {axis:?}");
                }
            }
        }
    }
}

//! The centres of cells in stored coordinates, as those of columns and of rows.

use std::ops::Range;

use super::search::first;
use spmesh_delaunay::predicates::Point2;
use spmesh_formats::raster::Grid;
use spmesh_stream::Coordinates;

/// Half a unit in the last place of one.
const ROUNDING: f64 = f64::EPSILON / 2.0;

/// The centres of cells along one axis: increasing abscissae of columns, or decreasing ordinates of rows.
///
/// A centre is converted from the world to stored coordinates once, and rounded. From then on it is an exact
/// point, like a vertex. Centres are monotone, because each step of their computation is. The inverse formula
/// maps a coordinate to its *place* among the centres, a real number, with an error bound. Where a place is
/// farther than the bound from all integers, its comparison with the centres is exact.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axis {
    first_side: f64,
    step: f64,
    scale: f64,
    offset: f64,
    pub(super) count: u32,
    /// Places per unit of the stored coordinate, and the place of coordinate zero.
    slope: f64,
    zero: f64,
    /// The part of the error bound that all places share.
    world: f64,
}

/// A computed number with an error bound.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// The computed value.
    pub(super) near: f64,
    /// The error bound.
    pub(super) error: f64,
}

impl Axis {
    /// `count` cells of length `step` from `first_side` on, in the world; the step is negative if coordinates
    /// decrease. World coordinates are stored ones times `scale` plus `offset`.
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
    /// Error: let u = 2^-53. The slope has a relative error of u, as has each product and sum; together below
    /// 3u of the product. The place of zero has an error of 3u (|offset| + |first side|) / step + u. The
    /// centre itself has an error of at most 2u (count + |first side| / step) + u from sums and products in
    /// the world, and 2u of itself from the difference and the quotient; its place in the world is below
    /// |first side| / step + count. The bound covers all of this and its own rounding.
    #[inline]
    pub(super) fn place(&self, x: f64) -> Place {
        let product = x * self.slope;
        Place { near: product + self.zero, error: 16.0 * ROUNDING * (product.abs() + self.world + 1.0) }
    }

    /// Places per unit of the stored coordinate.
    #[inline]
    pub(super) fn slope(&self) -> f64 {
        self.slope
    }

    /// The cells with centres in the closed interval between two coordinates.
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

    /// The first cell for which `holds` is true; it is true for all cells after the place, and for none
    /// before.
    #[inline]
    fn first_from(&self, place: Place, holds: impl FnMut(u32) -> bool) -> u32 {
        place.first_cell(0..self.count).unwrap_or_else(|| first(0..self.count, place.near, holds))
    }
}

impl Place {
    /// The first cell of a range after this place, or the end of the range; `None` if a cell is within the
    /// error bound.
    #[inline]
    pub(super) fn first_cell(&self, cells: Range<u32>) -> Option<u32> {
        let (low, high) = (self.near - self.error, self.near + self.error);
        // f64::ceil is slow on processors without an instruction for it.
        let up = |place: f64| {
            let below = place.min(f64::from(cells.end)) as u32;
            below + u32::from(f64::from(below) < place.min(f64::from(cells.end)))
        };
        let cell = up(low);
        // NaN fails the first comparison.
        let is_certain = low <= high && cell == up(high);
        is_certain.then(|| cell.max(cells.start))
    }
}

/// The centres of the cells of a grid, in stored coordinates. Each is an exact point after one rounding, so
/// triangles that cover the plane cover each centre.
#[derive(Debug, Clone, Copy)]
pub(super) struct Centers {
    pub(super) columns: Axis,
    pub(super) rows: Axis,
    /// Steps of x and y, in units of elevations.
    scale: Point2,
}

impl Centers {
    /// Centres for elevations of which one unit is `unit_of_z` units of x and y.
    pub(super) fn new(grid: Grid, coordinates: &Coordinates, unit_of_z: f64) -> Centers {
        let (scale, offset) = match coordinates {
            Coordinates::F64 => ([1.0; 2], [0.0; 2]),
            Coordinates::I32 { scale, offset } => ([scale[0], scale[1]], [offset[0], offset[1]]),
        };
        let Grid { left, top, step, columns, rows } = grid;
        Centers {
            columns: Axis::new(left, step, columns, scale[0], offset[0]),
            rows: Axis::new(top, -step, rows, scale[1], offset[1]),
            scale: scale.map(|step| step / unit_of_z),
        }
    }

    /// Converts a gradient from stored to world coordinates, all in one unit.
    pub(super) fn gradient_to_world(&self, gradient: Point2) -> Point2 {
        [0, 1].map(|axis| gradient[axis] / self.scale[axis])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The cells, by a linear search.
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

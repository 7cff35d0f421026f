//! The cell that a point is in.

use spmesh_formats::raster::Grid;
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::Point;

/// Units in the last place of coordinates by which plain arithmetic may be off.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Finds cells of a grid. A point nearer to a border than coordinates can tell is on it, and belongs to the cell to the
/// right of it, or above it.
#[derive(Debug)]
pub(crate) struct Placement {
    coordinates: Coordinates,
    grid: Grid,
    /// How far a place may be off, in cells.
    tolerance: f64,
}

impl Placement {
    pub(crate) fn new(grid: &Grid, coordinates: &Coordinates) -> Placement {
        let [right, bottom] = [grid.left + f64::from(grid.columns) * grid.step, grid.bottom()];
        let greatest = [grid.left, right, grid.top, bottom].into_iter().map(f64::abs).fold(0.0, f64::max);
        Placement { coordinates: *coordinates, grid: *grid, tolerance: ROUNDING * greatest / grid.step }
    }

    /// Column and row of the cell of a stored point; `None` if it is outside of the grid.
    #[inline]
    pub(crate) fn cell_of(&self, stored: &Point) -> Option<[usize; 2]> {
        let [x, y, _] = self.coordinates.to_world(*stored);
        let column = self.count((x - self.grid.left) / self.grid.step);
        // Rows count downwards, so the lower border belongs to the row below.
        let from_bottom = self.count((y - self.grid.bottom()) / self.grid.step);
        let is_inside = (0.0..f64::from(self.grid.columns)).contains(&column)
            && (0.0..f64::from(self.grid.rows)).contains(&from_bottom);
        is_inside.then(|| [column as usize, self.grid.rows as usize - 1 - from_bottom as usize])
    }

    /// The number of whole cells before a place.
    #[inline]
    fn count(&self, place: f64) -> f64 {
        let nearest = place.round();
        if (place - nearest).abs() <= self.tolerance { nearest } else { place.floor() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn borders_belong_to_the_right_and_upper_cells() {
        let grid = Grid { left: 0.3, top: 1.2, step: 0.1, columns: 6, rows: 9 };
        let coordinates = Coordinates::I32 { scale: [0.01; 3], offset: [0.0; 3] };
        let placement = Placement::new(&grid, &coordinates);
        for column in 0..6 {
            for row in 0..9 {
                let corner = [30.0 + 10.0 * column as f64, 110.0 - 10.0 * row as f64, 0.0];
                assert_eq!(placement.cell_of(&corner), Some([column, row]), "{corner:?}");
                assert_eq!(placement.cell_of(&[corner[0] + 9.0, corner[1] + 9.0, 0.0]), Some([column, row]));
            }
        }
        for outside in [[29.0, 50.0, 0.0], [90.0, 50.0, 0.0], [50.0, 29.0, 0.0], [50.0, 120.0, 0.0]] {
            assert_eq!(placement.cell_of(&outside), None, "{outside:?}");
        }
    }
}

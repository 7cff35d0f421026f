//! Cells around a raster, which decide values at its border.

use std::ops::Range;

use crate::files::{CELLS, TilePlace};
use spmesh_formats::raster::{Grid, TILE, Window};

/// A raster, and the larger one that is drawn for it, so that a window has the values that the whole raster
/// has there.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Surroundings {
    /// The grid of what is drawn.
    pub(super) drawn: Grid,
    /// Columns and rows of the raster among those that are drawn.
    pub(super) raster: [Range<u32>; 2],
}

impl Surroundings {
    /// The raster `grid`, whose cells follow from those up to `reach` cells away. There are none outside of
    /// the box of the mesh, if it is known.
    pub(super) fn new(grid: &Grid, reach: u32, mesh: Option<Window>) -> Surroundings {
        let (right, bottom) =
            (grid.left + f64::from(grid.columns) * grid.step, grid.top - f64::from(grid.rows) * grid.step);
        let Window { min, max } =
            mesh.unwrap_or(Window { min: [f64::NEG_INFINITY; 2], max: [f64::INFINITY; 2] });
        // Never more than a grid can have.
        let count = |beyond: f64| (beyond / grid.step).ceil().clamp(0.0, f64::from(reach)) as u32;
        let [west, east] = [count(grid.left - min[0]), count(max[0] - right)];
        let [north, south] = [count(max[1] - grid.top), count(bottom - min[1])];
        let drawn = Grid {
            left: grid.left - f64::from(west) * grid.step,
            top: grid.top + f64::from(north) * grid.step,
            step: grid.step,
            columns: grid.columns.saturating_add(west).saturating_add(east),
            rows: grid.rows.saturating_add(north).saturating_add(south),
        };
        Surroundings { drawn, raster: [west..west + grid.columns, north..north + grid.rows] }
    }

    /// How many cells of the raster have a value in a tile of what is drawn.
    pub(super) fn count_known(&self, at: TilePlace, values: &[f32]) -> u64 {
        let [columns, rows] = [0, 1].map(|axis| {
            let (first, Range { start, end }) = (at[axis] * TILE, self.raster[axis].clone());
            let place = |cell: u32| (cell as usize).saturating_sub(first).min(TILE);
            place(start)..place(end)
        });
        let rows = values[..CELLS].chunks_exact(TILE).skip(rows.start).take(rows.len());
        rows.map(|row| row[columns.clone()].iter().filter(|value| !value.is_nan()).count() as u64).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_raster_is_widened_where_the_mesh_goes_on() {
        let grid = Grid { left: 10.0, top: 20.0, step: 0.5, columns: 300, rows: 4 };
        let mesh = |min: [f64; 2], max: [f64; 2]| Some(Window { min, max });
        let whole = Surroundings::new(&grid, 9, mesh([10.0, 18.0], [160.0, 20.0]));
        assert_eq!((whole.drawn, whole.raster.clone()), (grid, [0..300, 0..4]));
        let some = Surroundings::new(&grid, 9, mesh([9.1, -1e300], [1e300, 20.5]));
        assert_eq!(some.raster, [2..302, 1..5]);
        assert_eq!(some.drawn, Grid { left: 9.0, top: 20.5, step: 0.5, columns: 311, rows: 14 });
        let mut values = vec![1.0; 2 * CELLS];
        values[3 * TILE + 4] = f32::NAN;
        assert_eq!(some.count_known([0, 0], &values), 4 * 254 - 1);
        assert_eq!(some.count_known([1, 0], &values), 4 * 46 - 1);
        assert_eq!(some.count_known([0, 1], &values), 0);
        assert_eq!(Surroundings::new(&grid, 2, None).raster, [2..302, 2..6]);
    }
}

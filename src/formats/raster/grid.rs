//! Where the cells of a raster are.

use std::ops::Range;

use spmesh_base::error::{Error, Result};
use spmesh_stream::model::points::Point2;

/// Greatest number of cells in a row or a column.
const CELLS_MAX: f64 = (1u32 << 31) as f64;
/// Greatest distance of the window from a given anchor, in steps: beyond it, steps cannot be counted exactly.
const STEPS_MAX: f64 = (1u64 << 48) as f64;
/// Cells along the longer side of a grid, by default.
const CELLS_DEFAULT: f64 = 1_000.0;

/// A grid of square cells, in rows from the top (north).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// The left (west) side of the first column.
    pub left: f64,
    /// The upper (north) side of the first row.
    pub top: f64,
    /// Sides of cells, above zero.
    pub step: f64,
    /// Number of columns.
    pub columns: u32,
    /// Number of rows.
    pub rows: u32,
}

/// How large cells are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cells {
    /// A given side, with cells aligned to its multiples from an anchor, so that grids of adjacent windows
    /// fit together.
    Step {
        /// Their side.
        step: f64,
        /// A corner of a cell.
        anchor: Point2,
    },
    /// This many columns.
    Columns(u32),
    /// This many rows.
    Rows(u32),
    /// A thousand along the longer side.
    Default,
}

/// A box in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Least coordinates.
    pub min: Point2,
    /// Greatest coordinates.
    pub max: Point2,
}

impl Grid {
    /// The grid of a window.
    ///
    /// # Errors
    /// As [`Grid::covering`].
    pub fn of(window: Window, cells: Cells) -> Result<Grid> {
        let [width, height] = [0, 1].map(|axis| window.max[axis] - window.min[axis]);
        // A given number of cells divides the window exactly. Taking half a cell off its far side keeps
        // rounding from adding a column or row.
        let exactly = |step: f64, counts: [Option<u32>; 2]| {
            let inner =
                [0, 1].map(|axis| window.max[axis] - if counts[axis].is_some() { 0.5 * step } else { 0.0 });
            Grid::covering(Window { min: window.min, max: inner }, step, window.min)
        };
        match cells {
            Cells::Step { step, anchor } => Grid::covering(window, step, anchor),
            _ if width.max(height) == 0.0 => Err(Error::usage(
                "the input spans no area, so the cells of a raster have no size: give --step",
            )),
            _ if !width.max(height).is_finite() => Err(Error::usage(
                "the window is wider than any number, so its cells have no size: give --bounds of a part \
                 of it",
            )),
            Cells::Columns(count) => exactly(width / f64::from(count), [Some(count), None]),
            Cells::Rows(count) => exactly(height / f64::from(count), [None, Some(count)]),
            Cells::Default => Grid::covering(window, width.max(height) / CELLS_DEFAULT, window.min),
        }
    }

    /// The smallest grid that covers a window with cells aligned to multiples of `step` from `anchor`, so
    /// that grids of adjacent windows fit together.
    ///
    /// # Errors
    /// Usage, if the step is not above zero, numbers are not finite, the anchor is too far away, or there are
    /// too many cells.
    pub fn covering(window: Window, step: f64, anchor: Point2) -> Result<Grid> {
        if !anchor.iter().all(|number| number.is_finite()) {
            let [x, y] = anchor;
            return Err(Error::usage(format!("a corner of cells at {x}, {y}: both must be finite")));
        }
        let numbers = [window.min, window.max];
        if !(step > 0.0 && step.is_finite() && numbers.as_flattened().iter().all(|number| number.is_finite()))
        {
            return Err(Error::usage(format!(
                "cells of size {step}: the size must be finite and above zero"
            )));
        }
        let [first, last] =
            [window.min, window.max].map(|corner| [0, 1].map(|axis| (corner[axis] - anchor[axis]) / step));
        if anchor != [0.0; 2] && first.iter().chain(&last).any(|count| count.abs() > STEPS_MAX) {
            let [x, y] = anchor;
            return Err(Error::usage(format!(
                "a corner of cells at {x}, {y} is too far away: take one nearer"
            )));
        }
        let (low, high) = (first.map(f64::floor), last.map(f64::ceil));
        // A window of width zero gets one column, and likewise one row.
        let counts = [0, 1].map(|axis| (high[axis] - low[axis]).max(1.0));
        if counts.iter().any(|&count| count.is_nan() || count > CELLS_MAX) {
            // A count beyond all rasters in few digits.
            let [columns, rows] =
                counts.map(|count| if count < 1e15 { count.to_string() } else { format!("{count:.0e}") });
            return Err(Error::usage(format!(
                "{columns} by {rows} cells of size {step} are more than a raster can have: take larger cells"
            )));
        }
        Ok(Grid {
            left: anchor[0] + low[0] * step,
            top: anchor[1] + (low[1] + counts[1]) * step,
            step,
            columns: counts[0] as u32,
            rows: counts[1] as u32,
        })
    }

    /// The grid of some columns and rows, which may be beyond those of this one.
    ///
    /// Domain: ranges of at most `u32::MAX` cells.
    pub fn part(&self, [columns, rows]: &[Range<i64>; 2]) -> Grid {
        Grid {
            left: self.left + columns.start as f64 * self.step,
            top: self.top - rows.start as f64 * self.step,
            step: self.step,
            columns: (columns.end - columns.start) as u32,
            rows: (rows.end - rows.start) as u32,
        }
    }

    /// The centre of a cell.
    pub fn center(&self, column: u32, row: u32) -> Point2 {
        [self.x_of(column), self.y_of(row)]
    }

    /// The abscissa of the centres of a column.
    pub fn x_of(&self, column: u32) -> f64 {
        self.left + (f64::from(column) + 0.5) * self.step
    }

    /// The ordinate of the centres of a row.
    pub fn y_of(&self, row: u32) -> f64 {
        self.top - (f64::from(row) + 0.5) * self.step
    }

    /// The lower side of the last row.
    pub fn bottom(&self) -> f64 {
        self.top - f64::from(self.rows) * self.step
    }

    /// Number of cells.
    pub fn cells(&self) -> u64 {
        u64::from(self.columns) * u64::from(self.rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grids_cover_their_window_at_multiples_of_the_step() {
        let window = Window { min: [0.3, -1.0], max: [4.1, 2.0] };
        let grid = Grid::covering(window, 0.5, [0.0, 0.0]).unwrap();
        assert_eq!(grid, Grid { left: 0.0, top: 2.0, step: 0.5, columns: 9, rows: 6 });
        assert_eq!((grid.center(0, 0), grid.center(8, 5)), ([0.25, 1.75], [4.25, -0.75]));
        assert_eq!((grid.bottom(), grid.cells()), (-1.0, 54));
        let shifted = Grid::covering(window, 2.0, [1.0, 0.5]).unwrap();
        assert_eq!(shifted, Grid { left: -1.0, top: 2.5, step: 2.0, columns: 3, rows: 2 });
        let point = Window { min: [1.0; 2], max: [1.0; 2] };
        assert_eq!(Grid::covering(point, 1.0, [0.0; 2]).unwrap().cells(), 1);
        for (window, step) in [
            (window, 0.0),
            (window, -1.0),
            (window, f64::NAN),
            (Window { min: [f64::NAN; 2], ..window }, 1.0),
        ] {
            assert!(Grid::covering(window, step, [0.0; 2]).is_err());
        }
        let error = Grid::covering(window, 1e-12, [0.0; 2]).unwrap_err().to_string();
        assert!(error.contains("take larger cells"), "{error}");
        let widest = Window { min: [f64::MIN, 0.0], max: [f64::MAX, 1.0] };
        for cells in [Cells::Columns(9), Cells::Rows(9), Cells::Default] {
            let error = Grid::of(widest, cells).unwrap_err().to_string();
            assert!(error.contains("the window is wider than any number"), "{error}");
        }
    }
}

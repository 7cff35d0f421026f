//! How a raster is divided into sheets.

use std::ops::Range;

use spmesh_base::error::{Error, Result};
use spmesh_base::limits::SHEETS_MAX;
use spmesh_formats::raster::Grid;

/// How large sheets are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SheetSize {
    /// Squares with this side. Units: those of the world.
    Side(f64),
    /// This many in a row and in a column.
    Counts([u32; 2]),
}

/// How a raster is divided into sheets: each cell belongs to one of them, and may be in the margins of
/// others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Division {
    /// How large they are.
    pub size: SheetSize,
    /// A corner of a square sheet. Others are at multiples of the side from it.
    pub anchor: [f64; 2],
    /// The width of the margin around each sheet. Units: those of the world.
    pub buffer: f64,
}

/// The sheets along an axis, in the order of columns or rows.
pub(super) type Strips = Vec<Strip>;

/// The sheets in a column or a row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Strip {
    /// What distinguishes their names.
    pub(super) name: String,
    /// Their cells, margins included.
    pub(super) cells: Range<u32>,
}

impl Division {
    /// The columns and rows of sheets of a grid. The sheets of least x and least y are the first column and
    /// the last row.
    pub(super) fn strips(&self, grid: &Grid) -> Result<[Strips; 2]> {
        self.check(grid)?;
        let columns = self.along(grid.columns, 0, grid.step, |column| grid.x_of(column))?;
        // Names count upwards, rows downwards.
        let mut rows = self.along(grid.rows, 1, grid.step, |row| grid.y_of(grid.rows - 1 - row))?;
        rows.reverse();
        for row in &mut rows {
            row.cells = grid.rows - row.cells.end..grid.rows - row.cells.start;
        }
        if columns.len() as u64 * rows.len() as u64 > SHEETS_MAX {
            return Err(too_many());
        }
        Ok([columns, rows])
    }

    fn check(&self, grid: &Grid) -> Result<()> {
        match self.size {
            SheetSize::Side(side) if !(side >= grid.step && side.is_finite()) => Err(Error::usage(format!(
                "rasters with a side of {side} are smaller than a cell, which has {}: give --tiles a greater side",
                grid.step
            ))),
            SheetSize::Counts([across, down]) if across > grid.columns || down > grid.rows => {
                Err(Error::usage(format!(
                    "{} by {} cells cannot be divided into {across} by {down} rasters: give --tiles smaller numbers",
                    grid.columns, grid.rows
                )))
            }
            _ => Ok(()),
        }
    }

    /// The sheets along an axis of `count` cells with these centres, which ascend.
    fn along(&self, count: u32, axis: usize, step: f64, centre: impl Fn(u32) -> f64) -> Result<Strips> {
        // The tolerance absorbs rounding where the margin is a multiple of the step.
        let margin = (self.buffer / step - 1e-9).ceil().clamp(0.0, f64::from(count)) as u32;
        let strip = |name: String, cells: Range<u32>| Strip {
            name,
            cells: cells.start.saturating_sub(margin)..cells.end.saturating_add(margin).min(count),
        };
        match self.size {
            SheetSize::Counts(counts) => {
                let number = u64::from(counts[axis]);
                if number > SHEETS_MAX {
                    return Err(too_many());
                }
                let start = |at: u64| (at * u64::from(count) / number) as u32;
                Ok((0..number).map(|at| strip(at.to_string(), start(at)..start(at + 1))).collect())
            }
            SheetSize::Side(side) => {
                let anchor = self.anchor[axis];
                let square_of = |cell: u32| ((centre(cell) - anchor) / side).floor();
                if square_of(count - 1) - square_of(0) >= SHEETS_MAX as f64 {
                    return Err(too_many());
                }
                let mut strips = Vec::new();
                let mut start = 0;
                while start < count {
                    let square = square_of(start);
                    let end = first(start + 1..count, |cell| square_of(cell) > square);
                    strips.push(strip(corner_name(anchor, side, square), start..end));
                    start = end;
                }
                Ok(strips)
            }
        }
    }
}

/// The first number of a range from which on a condition holds, or the end of the range.
fn first(range: Range<u32>, holds: impl Fn(u32) -> bool) -> u32 {
    let Range { start: mut low, end: mut high } = range;
    while low < high {
        let middle = low + (high - low) / 2;
        if holds(middle) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    low
}

/// The coordinate of a corner, with as many decimals as the anchor and the side have.
fn corner_name(anchor: f64, side: f64, square: f64) -> String {
    let decimals = |number: f64| number.to_string().split_once('.').map_or(0, |(_, digits)| digits.len());
    let digits = decimals(anchor).max(decimals(side));
    format!("{:.digits$}", anchor + square * side)
}

fn too_many() -> Error {
    Error::usage(format!("more than {SHEETS_MAX} rasters: give --tiles a greater side or smaller numbers"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strips(grid: &Grid, size: SheetSize, buffer: f64) -> [Vec<(String, Range<u32>)>; 2] {
        let division = Division { size, anchor: [0.0; 2], buffer };
        division
            .strips(grid)
            .unwrap()
            .map(|strips| strips.into_iter().map(|it| (it.name, it.cells)).collect())
    }

    #[test]
    fn each_cell_belongs_to_one_sheet() {
        let named = |strips: &[(&str, Range<u32>)]| -> Vec<(String, Range<u32>)> {
            strips.iter().map(|(name, cells)| (name.to_string(), cells.clone())).collect()
        };
        let grid = Grid { left: -1.0, top: 12.0, step: 0.5, columns: 10, rows: 7 };
        let [columns, rows] = strips(&grid, SheetSize::Side(2.0), 0.0);
        assert_eq!(columns, named(&[("-2", 0..2), ("0", 2..6), ("2", 6..10)]));
        assert_eq!(rows, named(&[("10", 0..4), ("8", 4..7)]));
        let [columns, _] = strips(&grid, SheetSize::Side(2.0), 0.6);
        assert_eq!(columns, named(&[("-2", 0..4), ("0", 0..8), ("2", 4..10)]));
        // Cells across a border belong to the sheet that has their centre.
        let [columns, _] = strips(&grid, SheetSize::Side(1.3), 0.0);
        assert_eq!(columns, named(&[("-1.3", 0..2), ("0.0", 2..5), ("1.3", 5..7), ("2.6", 7..10)]));
        let [columns, rows] = strips(&grid, SheetSize::Counts([3, 2]), 1.0);
        assert_eq!(columns, named(&[("0", 0..5), ("1", 1..8), ("2", 4..10)]));
        assert_eq!(rows, named(&[("1", 0..6), ("0", 2..7)]));
    }

    #[test]
    fn names_of_corners_are_decimals() {
        assert_eq!(corner_name(0.0, 0.1, 3.0), "0.3");
        assert_eq!(corner_name(0.25, 1000.0, 650.0), "650000.25");
        assert_eq!(corner_name(0.0, 1e3, -0.0), "0");
    }

    #[test]
    fn sheets_have_cells_and_a_limit() {
        let grid = Grid { left: 0.0, top: 1e6, step: 1.0, columns: 1 << 22, rows: 1 << 20 };
        let refused =
            |size| Division { size, anchor: [0.0; 2], buffer: 0.0 }.strips(&grid).unwrap_err().to_string();
        assert!(refused(SheetSize::Side(0.5)).contains("smaller than a cell"));
        assert!(refused(SheetSize::Side(f64::NAN)).contains("smaller than a cell"));
        assert!(refused(SheetSize::Side(1.0)).contains("more than"));
        assert!(refused(SheetSize::Side(100.0)).contains("more than"));
        assert!(refused(SheetSize::Counts([1 << 22, 1])).contains("more than"));
        assert!(refused(SheetSize::Counts([1, 1 << 21])).contains("cannot be divided"));
    }

    #[test]
    fn sheets_may_be_as_many_as_stated() {
        let most = SHEETS_MAX as u32;
        let count = |columns: u32, rows: u32, size: SheetSize| {
            let grid = Grid { left: 0.0, top: f64::from(rows), step: 1.0, columns, rows };
            let strips = Division { size, anchor: [0.0; 2], buffer: 0.0 }.strips(&grid);
            strips.map(|[across, down]| across.len() * down.len()).map_err(|error| error.to_string())
        };
        let refused =
            Err("more than 1048576 rasters: give --tiles a greater side or smaller numbers".to_string());
        for size in [SheetSize::Side(1.0), SheetSize::Side(1.5)] {
            // Of 1.5 cells, every second sheet has two.
            let across = if size == SheetSize::Side(1.0) { most } else { most / 2 * 3 };
            assert_eq!(count(across, 1, size), Ok(most as usize));
            assert_eq!(count(across + 1, 1, size), refused);
        }
        assert_eq!(count(most, 1, SheetSize::Counts([most, 1])), Ok(most as usize));
        assert_eq!(count(most + 1, 1, SheetSize::Counts([most + 1, 1])), refused);
        assert_eq!(count(1025, 1024, SheetSize::Counts([1024, 1024])), Ok(most as usize));
        assert_eq!(count(1025, 1024, SheetSize::Counts([1025, 1024])), refused);
    }
}

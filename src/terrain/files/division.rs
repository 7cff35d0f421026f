//! How a raster is divided into sheets.

use std::ops::Range;

use super::tiles::tiles_of;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::SHEETS_MAX;
use spmesh_formats::raster::Grid;

/// How far a side may be from a whole number of cells. Units: parts of the side.
const WHOLE: f64 = 1e-9;
/// How far a centre may be left of a border and still count as on it. Units: cells.
const ON_BORDER: f64 = 1e-6;
/// Greatest number of cells along a side of a full sheet; more tiles than a raster can have.
const CELLS_MAX: f64 = (1u32 << 31) as f64;

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
    /// Whether all sheets have the cells of a whole square and its margin, also where the raster ends.
    pub is_full: bool,
}

/// The sheets along an axis, in the order of columns or rows.
pub(super) type Strips = Vec<Strip>;

/// The sheets in a column or a row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Strip {
    /// The number of their squares, counted from the anchor; of sheets that are counted, from the first one.
    pub(super) number: f64,
    /// Their cells, margins included; those of full sheets may be beyond the grid.
    pub(super) cells: Range<i64>,
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
            row.cells = i64::from(grid.rows) - row.cells.end..i64::from(grid.rows) - row.cells.start;
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
            _ if self.is_full => self.check_full(grid),
            _ => Ok(()),
        }
    }

    /// Refuses full sheets whose sizes would differ, or that are larger than a raster can be.
    fn check_full(&self, grid: &Grid) -> Result<()> {
        let SheetSize::Side(side) = self.size else {
            return Err(Error::usage("full rasters are squares: give --tiles the length of their side"));
        };
        let cells = (side / grid.step).round();
        if ((side / grid.step) - cells).abs() > WHOLE * cells {
            return Err(Error::usage(format!(
                "rasters with a side of {side} are no whole number of cells, which have {}: give --tiles a multiple \
                 of it, or leave out --full",
                grid.step
            )));
        }
        let count = cells + 2.0 * self.margin(grid.step);
        let [columns, rows] = [count.min(CELLS_MAX) as u32; 2];
        tiles_of(&Grid { columns, rows, ..*grid }).map(drop)
    }

    /// The number of cells that cover the margin.
    fn margin(&self, step: f64) -> f64 {
        // The tolerance absorbs rounding where the margin is a multiple of the step.
        (self.buffer / step - 1e-9).ceil().max(0.0)
    }

    /// The sheets along an axis of `count` cells with these centres, which ascend.
    fn along(&self, count: u32, axis: usize, step: f64, centre: impl Fn(u32) -> f64) -> Result<Strips> {
        let all = i64::from(count);
        let margin = self.margin(step).min(if self.is_full { CELLS_MAX } else { f64::from(count) }) as i64;
        let strip = |number: f64, cells: Range<i64>| {
            let wide = cells.start - margin..cells.end + margin;
            let cells = if self.is_full { wide } else { wide.start.max(0)..wide.end.min(all) };
            Strip { number, cells }
        };
        match self.size {
            SheetSize::Counts(counts) => {
                let number = u64::from(counts[axis]);
                if number > SHEETS_MAX {
                    return Err(too_many());
                }
                let start = |at: u64| (at * u64::from(count) / number) as i64;
                Ok((0..number).map(|at| strip(at as f64, start(at)..start(at + 1))).collect())
            }
            SheetSize::Side(side) => {
                let anchor = self.anchor[axis];
                let square_of = |cell: u32| ((centre(cell) - anchor) / side).floor();
                if square_of(count - 1) - square_of(0) >= SHEETS_MAX as f64 {
                    return Err(too_many());
                }
                if self.is_full {
                    let near = ON_BORDER * step / side;
                    let square_of = |cell: u32| ((centre(cell) - anchor) / side + near).floor();
                    let first = square_of(0);
                    // All squares have as many cells, so those of the first one decide.
                    let low = (anchor + first * side - centre(0)) / step;
                    let (start, cells) = ((low - ON_BORDER).ceil() as i64, (side / step).round() as i64);
                    let squares = (square_of(count - 1) - first) as i64 + 1;
                    let square = |at: i64| start + at * cells..start + (at + 1) * cells;
                    return Ok((0..squares).map(|at| strip(first + at as f64, square(at))).collect());
                }
                let mut strips = Vec::new();
                let mut start = 0;
                while start < count {
                    let square = square_of(start);
                    let end = first(start + 1..count, |cell| square_of(cell) > square);
                    strips.push(strip(square, start.into()..end.into()));
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

fn too_many() -> Error {
    Error::usage(format!("more than {SHEETS_MAX} rasters: give --tiles a greater side or smaller numbers"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn division(size: SheetSize, buffer: f64) -> Division {
        Division { size, anchor: [0.0; 2], buffer, is_full: false }
    }

    fn numbered(division: &Division, grid: &Grid) -> [Vec<(f64, Range<i64>)>; 2] {
        let strips = division.strips(grid).unwrap();
        strips.map(|strips| strips.into_iter().map(|it| (it.number, it.cells)).collect())
    }

    fn strips(grid: &Grid, size: SheetSize, buffer: f64) -> [Vec<(f64, Range<i64>)>; 2] {
        numbered(&division(size, buffer), grid)
    }

    #[test]
    fn each_cell_belongs_to_one_sheet() {
        let grid = Grid { left: -1.0, top: 12.0, step: 0.5, columns: 10, rows: 7 };
        let [columns, rows] = strips(&grid, SheetSize::Side(2.0), 0.0);
        assert_eq!(columns, [(-1.0, 0..2), (0.0, 2..6), (1.0, 6..10)]);
        assert_eq!(rows, [(5.0, 0..4), (4.0, 4..7)]);
        let [columns, _] = strips(&grid, SheetSize::Side(2.0), 0.6);
        assert_eq!(columns, [(-1.0, 0..4), (0.0, 0..8), (1.0, 4..10)]);
        // Cells across a border belong to the sheet that has their centre.
        let [columns, _] = strips(&grid, SheetSize::Side(1.3), 0.0);
        assert_eq!(columns, [(-1.0, 0..2), (0.0, 2..5), (1.0, 5..7), (2.0, 7..10)]);
        let [columns, rows] = strips(&grid, SheetSize::Counts([3, 2]), 1.0);
        assert_eq!(columns, [(0.0, 0..5), (1.0, 1..8), (2.0, 4..10)]);
        assert_eq!(rows, [(1.0, 0..6), (0.0, 2..7)]);
    }

    #[test]
    fn full_sheets_have_the_cells_of_a_whole_square() {
        let full =
            |side: f64, buffer: f64| Division { is_full: true, ..division(SheetSize::Side(side), buffer) };
        let grid = Grid { left: -1.0, top: 12.0, step: 0.5, columns: 10, rows: 7 };
        let [columns, rows] = numbered(&full(2.0, 0.0), &grid);
        assert_eq!(columns, [(-1.0, -2..2), (0.0, 2..6), (1.0, 6..10)]);
        assert_eq!(rows, [(5.0, 0..4), (4.0, 4..8)]);
        let [columns, rows] = numbered(&full(2.0, 0.6), &grid);
        assert_eq!(columns, [(-1.0, -4..4), (0.0, 0..8), (1.0, 4..12)]);
        assert_eq!(rows, [(5.0, -2..6), (4.0, 2..10)]);
        // Centres of cells on the borders of squares belong to those on the right.
        let shifted = Grid { left: 649_999.9, step: 0.2, columns: 3, ..grid };
        let [columns, _] = numbered(&full(0.4, 0.0), &shifted);
        assert_eq!(columns, [(1_625_000.0, 0..2), (1_625_001.0, 2..4)]);
        let refused = |division: Division| division.strips(&grid).unwrap_err().to_string();
        assert!(refused(full(1.3, 0.0)).contains("no whole number of cells"));
        assert!(refused(full(1e9, 0.0)).contains("tiles, at most"));
        assert!(refused(full(2.0, 1e300)).contains("tiles, at most"));
        let counted = Division { size: SheetSize::Counts([2, 2]), ..full(2.0, 0.0) };
        assert!(refused(counted).contains("full rasters are squares"));
    }

    #[test]
    fn sheets_have_cells_and_a_limit() {
        let grid = Grid { left: 0.0, top: 1e6, step: 1.0, columns: 1 << 22, rows: 1 << 20 };
        let refused = |size| division(size, 0.0).strips(&grid).unwrap_err().to_string();
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
            let strips = division(size, 0.0).strips(&grid);
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

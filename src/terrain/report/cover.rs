//! The second pass over points, in cells as small as their spacing: voids, and the grid that flight lines are
//! compared on.

use super::Options;
use super::fields::Fields;
use super::lines::{Lines, Overlap};
use super::picture::{Frame, Picture};
use super::tally::{Density, Tally};
use crate::accumulators::Accumulators;
use crate::files::{TilePlace, places, tiles_of};
use crate::points::place::Placement;
use spmesh_base::error::Result;
use spmesh_formats::raster::{Grid, TILE, Window};
use spmesh_formats::source::Input;

/// A void is as wide as so many pulse spacings, says the specification; and pulses should be in nine of ten
/// squares that are half as wide.
///
/// Source: USGS, Lidar Base Specification 2024 rev. A, "Data voids" and "Spatial distribution and
/// regularity".
const SPACINGS: f64 = 4.0;
/// Most columns and rows of cells: their first and last cells are in memory.
const LINES_MAX: u64 = 1 << 20;

/// Where pulses are, and where not.
#[derive(Debug)]
pub struct Cover {
    /// Side of cells: four pulse spacings.
    pub cell: f64,
    /// Cells of the extent of the points.
    pub cells: u64,
    /// Those without a first return: voids.
    pub voids: u64,
    /// Quarters of the cells of the extent that have a first return.
    pub quarters: u64,
    /// Points outside of the frame, which are far from the others.
    pub outside: u64,
    /// Share of voids.
    pub picture: Picture,
}

/// Reads all points again; calls `progress` with their number. Returns `None` for both if there are no
/// points.
///
/// Memory: that of `options`. Disk: 72 bytes for each cell and flight line, if memory has no room for them.
///
/// # Errors
/// If the input is malformed or cannot be read; memory, if `options.memory` is too little for tiles of cells.
pub fn cover(
    input: &Input,
    tally: &Tally,
    options: &Options,
    mut progress: impl FnMut(u64),
) -> Result<(Option<Cover>, Option<Overlap>)> {
    let Some(density) = tally.density.as_ref().filter(|_| tally.first() > 0) else { return Ok((None, None)) };
    let description = input.description();
    let fields = Fields::of(&description.attributes);
    let grid = grid(density, options.spacing)?;
    let halves = Grid { step: 0.5 * grid.step, columns: 2 * grid.columns, rows: 2 * grid.rows, ..grid };
    let placement = Placement::new(&halves, &description.coordinates);
    let temp_dir = options.temp_dir.as_deref();
    let mut seen = Accumulators::new(0u8, &halves, options.memory / 8, temp_dir)?;
    let mut lines = Lines::new(&grid, tally, description.coordinates, options)?;
    let (mut reader, mut batch, mut points, mut outside) = (input.read()?, Vec::new(), 0, 0);
    loop {
        reader.next_batch(&mut batch)?;
        if batch.is_empty() {
            break;
        }
        points += batch.len() as u64;
        for (number, stored) in batch.iter().enumerate() {
            let Some([column, row]) = placement.cell_of(stored) else {
                outside += 1;
                continue;
            };
            let carried = fields.read(reader.rows(), number);
            if carried.is_first {
                *seen.cell([column / TILE, row / TILE], row % TILE * TILE + column % TILE)? = 1;
            }
            if let Some(lines) = &mut lines {
                lines.add(&carried, [column / 2, row / 2], stored)?;
            }
        }
        progress(points);
    }
    let mut cover = Extent::of(&halves, &mut seen)?.cover(&grid, &halves, &mut seen)?;
    cover.outside = outside;
    drop(seen);
    Ok((Some(cover), lines.map(Lines::finish).transpose()?))
}

/// The grid of cells that are four pulse spacings wide, rounded up to two digits, and twice as wide until
/// they are few enough.
fn grid(density: &Density, spacing: Option<f64>) -> Result<Grid> {
    let mut step = spacing.map_or_else(|| round_up(SPACINGS * density.spacing), |spacing| SPACINGS * spacing);
    let Frame { min, max } = density.frame;
    loop {
        let grid = Grid::covering(Window { min, max }, step, [0.0; 2]);
        let is_small = |grid: &Grid| {
            let [columns, rows] = [grid.columns, grid.rows].map(|count| 2 * u64::from(count));
            columns.max(rows) <= LINES_MAX
                && tiles_of(grid).is_ok_and(|[across, down]| across * down <= 1 << 20)
        };
        match grid {
            Ok(grid) if !is_small(&grid) => step *= 2.0,
            Err(_) if step < 1e300 && max.iter().chain(&min).all(|side| side.is_finite()) => step *= 2.0,
            other => return other,
        }
    }
}

/// The least number of two digits that is not below `length`.
fn round_up(length: f64) -> f64 {
    let exponent = length.log10().floor() as i32 - 1;
    // Powers of ten are exact as divisors of numbers of two digits, as factors they are not.
    let digits = if exponent < 0 { length * 10f64.powi(-exponent) } else { length / 10f64.powi(exponent) };
    let digits = (digits - 1e-9).ceil();
    if exponent < 0 { digits / 10f64.powi(-exponent) } else { digits * 10f64.powi(exponent) }
}

/// The extent of the points: the cells that have one with first returns, or that have such cells both to the
/// left and to the right, and above and below.
struct Extent {
    columns: Vec<Ends>,
    rows: Vec<Ends>,
}

/// The first and last cell of a column or row with first returns.
type Ends = Option<[u32; 2]>;

fn widen(ends: &mut Ends, at: u32) {
    let [first, last] = ends.unwrap_or([at; 2]);
    *ends = Some([first.min(at), last.max(at)]);
}

impl Extent {
    /// The extent of quarters of cells.
    fn of(halves: &Grid, seen: &mut Accumulators<u8>) -> Result<Extent> {
        let mut columns = vec![None; halves.columns as usize / 2];
        let mut rows = vec![None; halves.rows as usize / 2];
        for at in places(tiles_of(halves)?) {
            let Some(cells) = seen.read(at)? else { continue };
            for (number, _) in cells.iter().enumerate().filter(|(_, seen)| **seen > 0) {
                let column = (at[0] * TILE + number % TILE) / 2;
                let row = (at[1] * TILE + number / TILE) / 2;
                widen(&mut columns[column], row as u32);
                widen(&mut rows[row], column as u32);
            }
        }
        Ok(Extent { columns, rows })
    }

    /// Counts the cells of the extent.
    fn cover(&self, grid: &Grid, halves: &Grid, seen: &mut Accumulators<u8>) -> Result<Cover> {
        let bottom = grid.top - f64::from(grid.rows) * grid.step;
        let right = grid.left + f64::from(grid.columns) * grid.step;
        let frame = Frame { min: [grid.left, bottom], max: [right, grid.top] };
        let picture = Picture::of(&frame, grid.step);
        let mut cover = Cover { cell: grid.step, cells: 0, voids: 0, quarters: 0, outside: 0, picture };
        for at in places(tiles_of(halves)?) {
            if self.meets(at) {
                self.cover_tile(at, grid, seen.read(at)?, &mut cover);
            }
        }
        Ok(cover)
    }

    /// The rows of cells of a tile.
    fn rows_of(&self, at: TilePlace) -> impl Iterator<Item = (usize, [usize; 2])> {
        let rows = at[1] * TILE / 2..((at[1] + 1) * TILE / 2).min(self.rows.len());
        let tile = [at[0] * TILE / 2, (at[0] + 1) * TILE / 2 - 1];
        rows.filter_map(move |row| {
            let [first, last] = self.rows[row]?.map(|column| column as usize);
            let (first, last) = (first.max(tile[0]), last.min(tile[1]));
            (first <= last).then_some((row, [first, last]))
        })
    }

    fn meets(&self, at: TilePlace) -> bool {
        self.rows_of(at).next().is_some()
    }

    fn cover_tile(&self, at: TilePlace, grid: &Grid, seen: Option<&[u8]>, cover: &mut Cover) {
        for (row, [first, last]) in self.rows_of(at) {
            for column in first..=last {
                let is_between = self.columns[column]
                    .is_some_and(|[top, low]| (top as usize..=low as usize).contains(&row));
                if !is_between {
                    continue;
                }
                let place = 2 * row % TILE * TILE + 2 * column % TILE;
                let quarters =
                    [0, 1, TILE, TILE + 1].map(|beside| seen.map_or(0, |seen| seen[place + beside]));
                let quarters: u64 = quarters.into_iter().map(u64::from).sum();
                let is_void = quarters == 0;
                cover.cells += 1;
                cover.voids += u64::from(is_void);
                cover.quarters += quarters;
                let centre = grid.center(column as u32, row as u32);
                cover.picture.add(centre, [f64::from(u8::from(is_void)), 1.0]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_are_rounded_up_to_two_digits() {
        for (length, expected) in
            [(1.234, 1.3), (1.2, 1.2), (99.1, 100.0), (0.0561, 0.057), (1234.0, 1300.0), (3.0, 3.0)]
        {
            assert_eq!(round_up(length), expected, "{length}");
        }
    }
}

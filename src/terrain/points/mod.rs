//! `spdem --points`: rasters of what the points in each cell are like.
//!
//! `place` finds the cell of a point. `statistic` says what is kept of the points of a cell, and what follows
//! from it; it counts and sums in integers, so the order of the points does not matter. The cells are in
//! [`Accumulators`].

pub(crate) mod place;
mod statistic;

use std::io::{Read, Seek, Write};
use std::ops::Range;

use crate::accumulators::Accumulators;
use crate::files::{CELLS, Destination, TilePlace, TileSource, places, tiles_of};
use place::Placement;
use spmesh_base::error::{Error, Result};
use spmesh_formats::raster::{Grid, RasterFile, RasterOptions, Reduction, Reference, Samples, TILE, Window};
use spmesh_stream::model::attributes::Column;
use spmesh_stream::{Coordinates, Crs, Event, Header, Kind, StreamReader};
pub use statistic::Statistic;
use statistic::{Cell, Steps};

/// What is counted, and the memory for it.
#[derive(Debug, Clone)]
pub struct Options {
    /// What cells hold.
    pub statistic: Statistic,
    /// The attribute that it is of, as `spmesh_stream::model::attributes::Attributes::column` takes it;
    /// elevations if `None`.
    pub attribute: Option<String>,
    /// Bytes for cells; others wait in a temporary file.
    pub memory: u64,
    /// How the raster is written.
    pub raster: RasterOptions,
    /// The coordinate reference system, if not that of the points.
    pub crs: Option<Crs>,
}

/// Counts of a run.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Stats {
    /// Points of the stream.
    pub points: u64,
    /// Points outside of the raster.
    pub outside: u64,
    /// Points whose value is unknown, which are left out.
    pub unknown: u64,
    /// Cells of the raster.
    pub cells: u64,
    /// Cells with a value.
    pub known: u64,
    /// Number of tiles written to the temporary file.
    pub spilled: u64,
    /// Bytes read.
    pub input_bytes: u64,
    /// What the user should know of the coordinate reference system.
    pub notices: Vec<String>,
}

/// The window that has all points of a stream in its cells, in world coordinates. Points on a border between
/// cells are in the right or upper one, so it ends a little above the greatest coordinates.
///
/// # Errors
/// Usage, if the header has no bounds.
pub fn window(header: &Header) -> Result<Window> {
    let Some(bounds) = header.bounds else {
        return Err(Error::usage("the header does not say where the points are: give --bounds"));
    };
    let [min, max] = [bounds.min, bounds.max].map(|corner| header.coordinates.to_world(corner));
    let beyond = |axis: usize| match header.coordinates {
        Coordinates::F64 => max[axis].next_up(),
        Coordinates::I32 { scale, .. } => (max[axis] + 0.5 * scale[axis]).max(max[axis].next_up()),
    };
    Ok(Window { min: [min[0], min[1]], max: [beyond(0), beyond(1)] })
}

/// Checks that a stream holds points with what is asked for; returns the column of an attribute.
///
/// # Errors
/// Usage, if not.
pub fn check(header: &Header, options: &Options) -> Result<Option<Column>> {
    if header.kind != Kind::Points {
        let what = format!("this is a stream of kind {}, expected points", header.kind.name());
        return Err(Error::usage(format!("{what}: spfinalize makes a stream of them")));
    }
    if let Some(name) = &options.attribute {
        let column = header.attributes.column(name).map_err(|what| {
            Error::usage(format!("{what}: spfinalize --attributes takes attributes of points along"))
        })?;
        return Ok(Some(column));
    }
    // An input without points may not tell whether they would have elevations.
    let is_flat = !header.has_elevation && header.dims == 2 && header.points != Some(0);
    if options.statistic.is_value() && is_flat {
        return Err(Error::usage(
            "points have no elevation: give points x y z to spfinalize, or --attribute",
        ));
    }
    Ok(None)
}

/// Writes the raster of a stream of points; calls `progress` with the number of points read.
///
/// A point on the border between two cells is in the right or upper one. Sums are exact, and rounded at the
/// end only, so the raster does not depend on the order of the points.
///
/// Memory: `options.memory` for cells, and some 50 bytes for each tile.
///
/// # Errors
/// If the input is no stream of points, is malformed or truncated; if values are too great; if there are too
/// many tiles; if writing fails.
pub fn rasterize<R: Read, W: Write + Seek>(
    reader: &mut StreamReader<R>,
    output: Destination<W>,
    grid: &Grid,
    options: &Options,
    progress: impl FnMut(u64),
) -> Result<Stats> {
    let header = reader.header().clone();
    let column = check(&header, options).map_err(|e| e.of_input(reader.name()))?;
    tiles_of(grid)?;
    let crs = options.crs.as_ref().unwrap_or(&header.crs);
    let are_elevations = column.is_none() && options.statistic.is_value();
    let reference = Reference::of_crs(crs, are_elevations, options.raster.format);
    let file = RasterFile {
        options: &options.raster,
        grid: *grid,
        reference: &reference,
        reduction: Reduction::Mean,
        samples: Samples::Floats,
        is_staged: false,
    };
    let steps = Steps::of(&header, column.as_ref());
    let mut stats = Stats { cells: grid.cells(), ..Stats::default() };
    let (mut stats, [spilled, _]) = output.write(&file, options.memory, |target, memory| {
        let mut counters =
            Accumulators::new(Cell::default(), grid, memory, options.raster.temp_dir.as_deref())?;
        count(reader, column.as_ref(), &steps, grid, &mut counters, &mut stats, progress)?;
        stats.spilled = counters.spilled;
        let mut tiles = Finished { counters, statistic: options.statistic, steps, grid: *grid, known: 0 };
        let mut values = vec![f32::NAN; CELLS];
        for at in places(tiles_of(grid)?) {
            if tiles.get(at, &mut values)? {
                target.put(at, &values)?;
            }
        }
        stats.known = tiles.known;
        Ok(stats)
    })?;
    stats.spilled += spilled;
    stats.input_bytes = reader.bytes_read();
    stats.notices = reference.notices;
    Ok(stats)
}

/// Counts all points.
fn count<R: Read>(
    reader: &mut StreamReader<R>,
    column: Option<&Column>,
    steps: &Steps,
    grid: &Grid,
    counters: &mut Accumulators<Cell>,
    stats: &mut Stats,
    mut progress: impl FnMut(u64),
) -> Result<()> {
    let placement = Placement::new(grid, &reader.header().coordinates);
    while let Some(event) = reader.next_event()? {
        let Event::Points(points) = event else { continue };
        stats.points += points.len() as u64;
        let rows = reader.rows();
        for (number, point) in points.iter().enumerate() {
            let Some([x, y]) = placement.cell_of(point) else {
                stats.outside += 1;
                continue;
            };
            let value = column.map_or(point[2], |column| column.of(rows, number));
            if value.is_nan() {
                stats.unknown += 1;
                continue;
            }
            let steps = steps.to_steps(value).map_err(|e| reader.locate(e))?;
            let (tile, cell) = ([x / TILE, y / TILE], y % TILE * TILE + x % TILE);
            counters.cell(tile, cell)?.add(steps).map_err(|e| reader.locate(e))?;
        }
        progress(stats.points);
    }
    Ok(())
}

/// The tiles of a raster, made from the counters of their cells.
struct Finished {
    counters: Accumulators<Cell>,
    statistic: Statistic,
    steps: Steps,
    grid: Grid,
    /// Number of cells with a value.
    known: u64,
}

impl TileSource for Finished {
    fn get(&mut self, at: TilePlace, values: &mut [f32]) -> Result<bool> {
        let cells = self.counters.read(at)?;
        if cells.is_none() && self.statistic.is_value() {
            return Ok(false);
        }
        values.fill(f32::NAN);
        let inside = |count: u32, at: usize| -> Range<usize> { 0..(count as usize - at * TILE).min(TILE) };
        let area = self.grid.step * self.grid.step;
        for (y, x) in
            inside(self.grid.rows, at[1]).flat_map(|y| inside(self.grid.columns, at[0]).map(move |x| (y, x)))
        {
            let cell = cells.map_or(Cell::default(), |cells| cells[y * TILE + x]);
            let value = self.statistic.of(&cell, &self.steps, area);
            values[y * TILE + x] = value;
            self.known += u64::from(!value.is_nan());
        }
        Ok(true)
    }
}

//! Evaluates splines in the cells of a grid.

use std::io::{Seek, Write};
use std::num::NonZeroUsize;

use super::attributes::Attribute;
use super::layout::Spline;
use super::table;
use super::values::line;
use crate::bases::{Raster, Scratch};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::parallel;
use spmesh_delaunay::predicates::Point2;
use spmesh_formats::raster::{self, Grid, RasterFile, RasterOptions, Reduction, Reference, Samples, Window};
use spmesh_formats::sink::{NPY_F64, npy_header};
use spmesh_stream::Crs;

/// Rows that a thread evaluates at a time: enough to outweigh the start of a sweep, which looks at all
/// elements.
const ROWS_PER_THREAD: usize = 64;

impl Spline {
    /// The box of the domain, in world coordinates.
    ///
    /// # Errors
    /// A domain without an area.
    pub fn window(&self) -> Result<Window> {
        self.layout.domain_window()
    }

    /// The coordinate reference system of its domain.
    pub fn crs(&self) -> &Crs {
        &self.layout.frame.crs
    }
}

/// Writes a raster of one number per cell, at the centres of cells; cells outside of the domain have no data.
/// Returns the number of cells without data, and what the user should know of the coordinate reference
/// system.
///
/// # Errors
/// Usage, for an attribute of several numbers; if writing fails.
pub fn write_raster<W: Write + Seek>(
    spline: &Spline,
    attribute: Attribute,
    grid: &Grid,
    options: &RasterOptions,
    threads: NonZeroUsize,
    output: &mut W,
    mut done: impl FnMut(u64),
) -> Result<(u64, Vec<String>)> {
    if !attribute.is_single() {
        return Err(Error::usage(
            "a raster has one number in a cell: take .npy or --format text for several",
        ));
    }
    let mut bands = Bands::new(spline, attribute, grid, threads);
    let mut unknown = 0;
    let reduction = if attribute == Attribute::Aspect { Reduction::First } else { Reduction::Mean };
    let crs = &spline.layout.frame.crs;
    let reference = Reference::of_crs(crs, attribute == Attribute::Value, options.format);
    let file = RasterFile {
        options,
        grid: *grid,
        reference: &reference,
        reduction,
        samples: Samples::Floats,
        is_staged: false,
    };
    raster::write_rows(output, &file, |row, values| {
        for (value, &found) in values.iter_mut().zip(bands.row(row as usize)?) {
            *value = found as f32;
            unknown += u64::from(value.is_nan());
            if value.is_infinite() {
                let what =
                    format!("value {found:e} is too great for a raster, which has 32 bits: scale elevations");
                return Err(Error::usage(what));
            }
        }
        done(u64::from(row) + 1);
        Ok(())
    })?;
    Ok((unknown, reference.notices))
}

/// Writes an array of numpy with the attribute in each cell; NaN without data. Returns the number of
/// cells without data.
///
/// Shape: (rows, columns), or (rows, columns, numbers) for attributes of several numbers. The first row is
/// the top one, as in rasters.
///
/// # Errors
/// If writing fails.
pub fn write_cell_array(
    spline: &Spline,
    attribute: Attribute,
    grid: &Grid,
    threads: NonZeroUsize,
    output: &mut impl Write,
    mut done: impl FnMut(u64),
) -> Result<u64> {
    let mut bands = Bands::new(spline, attribute, grid, threads);
    let shape = [grid.rows.into(), grid.columns.into(), bands.width as u64];
    let shape = if attribute.is_single() { &shape[..2] } else { &shape[..] };
    output.write_all(&npy_header(NPY_F64, shape)).map_err(table::write_error)?;
    let (mut bytes, mut unknown) = (Vec::new(), 0);
    for row in 0..grid.rows {
        let width = bands.width;
        let values = bands.row(row as usize)?;
        unknown += values.iter().step_by(width).filter(|value| value.is_nan()).count() as u64;
        bytes.clear();
        values.iter().for_each(|value| bytes.extend_from_slice(&value.to_le_bytes()));
        output.write_all(&bytes).map_err(table::write_error)?;
        done(u64::from(row) + 1);
    }
    Ok(unknown)
}

/// Writes a table with a line for each cell in the domain, row by row from the top: its centre and the
/// attribute.
///
/// # Errors
/// If writing fails.
pub fn write_table(
    spline: &Spline,
    attribute: Attribute,
    grid: &Grid,
    output: &mut impl Write,
    mut done: impl FnMut(u64),
) -> Result<u64> {
    table::write_title(output, ["x", "y"].iter().chain(attribute.columns()))?;
    let (mut scratch, mut text, mut outside) = (Scratch::default(), Vec::new(), 0);
    for row in 0..grid.rows {
        text.clear();
        for column in 0..grid.columns {
            let at = grid.center(column, row);
            match spline.jet(at, attribute, &mut scratch) {
                Some(jet) => line(&mut text, at, attribute, Some(&jet)),
                None => outside += 1,
            }
        }
        output.write_all(&text).map_err(table::write_error)?;
        done(u64::from(row) + 1);
    }
    Ok(outside)
}

/// Rows of a grid, evaluated band by band by several threads.
struct Bands<'a> {
    spline: &'a Spline,
    attribute: Attribute,
    grid: &'a Grid,
    threads: NonZeroUsize,
    /// Numbers of a cell.
    width: usize,
    /// The first row of the current band.
    first: usize,
    values: Vec<f64>,
}

impl<'a> Bands<'a> {
    fn new(spline: &'a Spline, attribute: Attribute, grid: &'a Grid, threads: NonZeroUsize) -> Bands<'a> {
        let width = attribute.columns().len();
        Bands { spline, attribute, grid, threads, width, first: 0, values: Vec::new() }
    }

    fn row_len(&self) -> usize {
        self.grid.columns as usize * self.width
    }

    /// A row; callers request rows in order.
    fn row(&mut self, row: usize) -> Result<&[f64]> {
        let len = self.row_len();
        if row * len >= self.first * len + self.values.len() {
            self.evaluate(row)?;
        }
        Ok(&self.values[(row - self.first) * len..][..len])
    }

    fn evaluate(&mut self, first: usize) -> Result<()> {
        let (len, rows) = (self.row_len(), self.grid.rows as usize);
        let count = (rows - first).min(ROWS_PER_THREAD * self.threads.get());
        self.first = first;
        self.values.clear();
        self.values.resize(count * len, f64::NAN);
        let mut all = std::mem::take(&mut self.values);
        let share = count.div_ceil(self.threads.get());
        let parts = all.chunks_mut(share * len).enumerate();
        let outcome = parallel::map(self.threads, parts, |(number, part)| {
            self.evaluate_part(first + number * share, part)
        });
        self.values = all;
        outcome.map(drop)
    }

    /// Evaluates the rows from `first` on.
    fn evaluate_part(&self, first: usize, values: &mut [f64]) -> Result<()> {
        let rows = first..first + values.len() / self.row_len();
        match self.attribute {
            Attribute::Value if !self.spline.beyond.is_any() => self.sweep(rows.start, values),
            attribute => {
                let mut scratch = Scratch::default();
                for (row, values) in rows.zip(values.chunks_exact_mut(self.row_len())) {
                    for (column, cell) in (0..).zip(values.chunks_exact_mut(self.width)) {
                        let at = self.grid.center(column, row as u32);
                        attribute.fill(self.spline.jet(at, attribute, &mut scratch).as_ref(), cell);
                    }
                }
                Ok(())
            }
        }
    }

    fn sweep(&self, first: usize, values: &mut [f64]) -> Result<()> {
        let (grid, columns) = (self.grid, self.grid.columns as usize);
        let Spline { layout, coefficients, .. } = self.spline;
        let step = grid.step / layout.frame.step();
        let raster = Raster {
            origin: layout.frame.to_stored(grid.center(0, first as u32)),
            step: [step, -step],
            columns,
            rows: values.len() / columns,
        };
        layout.basis.raster(coefficients, &raster, |row| {
            let into = &mut values[row.row * columns..][..columns];
            into[row.domain.clone()].copy_from_slice(&row.values[row.domain]);
            Ok(())
        })
    }
}

impl super::Layout {
    /// The box of the domain, in world coordinates.
    ///
    /// # Errors
    /// Usage, if there is no domain.
    pub fn domain_window(&self) -> Result<Window> {
        let corners = self.basis.domain_corners();
        let corners = corners.iter().map(|&corner| self.frame.to_world(corner));
        let bounds = corners.fold(None, |bounds: Option<[Point2; 2]>, corner| {
            let [least, greatest] = bounds.unwrap_or([corner; 2]);
            Some([[0, 1].map(|i| least[i].min(corner[i])), [0, 1].map(|i| greatest[i].max(corner[i]))])
        });
        match bounds {
            Some([min, max]) if min[0] < max[0] && min[1] < max[1] => Ok(Window { min, max }),
            _ => Err(Error::usage(
                "functions sum to one nowhere: use more knots, or pull those of the border apart",
            )),
        }
    }
}

//! Mean, least and greatest elevations of the surface over whole cells.
//!
//! Each triangle is cut at the sides of cells (`cut`). What it adds to a cell is rounded to integers and then
//! added up, so the order of triangles does not matter. A cell may get a part of a triangle at any time, so
//! all tiles wait for the end of the mesh.

use bytemuck::{Pod, Zeroable};

use super::cut::{Cutter, Polygon};
use super::options::Sample;
use super::stages::Stages;
use super::tile_cache::TileCache;
use crate::accumulators::Accumulators;
use crate::files::{CELLS, places};
use spmesh_base::error::{Error, Result};
use spmesh_formats::raster::{Grid, TILE};
use spmesh_stream::model::bounds::Point;
use std::path::Path;

/// Steps of the area of a cell.
const AREA_STEPS: f64 = (1u64 << 60) as f64;
/// Values have at most 2^60 steps, so that products with areas fit 128 bits.
const VALUE_BITS: i32 = 60;
const VALUE_STEPS_MAX: f64 = (1u64 << VALUE_BITS) as f64;
/// Steps in a unit of values, if the greatest one is not known: up to 2^40 units are possible.
const VALUE_STEPS: f64 = (1u64 << 20) as f64;

/// What the surface over a cell is like so far.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Cover {
    /// The sum of elevations times areas, in steps of both.
    sum: i128,
    /// The covered area.
    area: u64,
    /// The least and the greatest elevation.
    least: f32,
    greatest: f32,
}

const BLANK: Cover = Cover { sum: 0, area: 0, least: f32::INFINITY, greatest: f32::NEG_INFINITY };

/// The cells of a raster, and the surface over them.
///
/// Memory: the budget; 32 bytes for each cell of a tile.
#[derive(Debug)]
pub(super) struct Coverage {
    sample: Sample,
    /// Columns and rows.
    size: [u32; 2],
    steps_per_unit: f64,
    cells: Accumulators<Cover>,
    cutter: Cutter,
}

impl Coverage {
    /// Nothing covered so far. `greatest` is the greatest magnitude of values, if it is known.
    pub(super) fn new(
        sample: Sample,
        grid: &Grid,
        greatest: Option<f64>,
        memory: u64,
        temp_dir: Option<&Path>,
    ) -> Result<Coverage> {
        let steps_per_unit = greatest.map_or(VALUE_STEPS, |greatest| {
            let exponent = greatest.max(f64::MIN_POSITIVE).log2().ceil().clamp(-900.0, 900.0) as i32;
            2f64.powi(VALUE_BITS - 1 - exponent)
        });
        let cells = Accumulators::new(BLANK, grid, memory, temp_dir)?;
        let size = [grid.columns, grid.rows];
        Ok(Coverage { sample, size, steps_per_unit, cells, cutter: Cutter::new() })
    }

    /// Adds a triangle with corners in the coordinates of cells.
    pub(super) fn add(&mut self, placed: [Point; 3]) -> Result<()> {
        let limits = placed.map(|corner| corner[2]);
        let [low, high] = [
            limits.into_iter().fold(f64::INFINITY, f64::min),
            limits.into_iter().fold(f64::NEG_INFINITY, f64::max),
        ];
        let (cells, steps_per_unit) = (&mut self.cells, self.steps_per_unit);
        let is_mean = self.sample == Sample::Mean;
        self.cutter.cells_of(placed, self.size, |[column, row], part: &Polygon| {
            let (area, mean) = part.integral();
            let area = rounded(area.min(1.0) * AREA_STEPS) as u64;
            if area == 0 {
                return Ok(());
            }
            let mean = mean.clamp(low, high);
            let steps = mean * steps_per_unit;
            if steps.is_nan() || steps.abs() > VALUE_STEPS_MAX {
                return Err(Error::usage(format!(
                    "a value of {mean:e} is too great for --sample: scale values"
                )));
            }
            let (tile, cell) = ([column / TILE, row / TILE], row % TILE * TILE + column % TILE);
            let cover = cells.cell(tile, cell)?;
            // The parts of a cell add up to its area, but for their rounding.
            cover.area = cover.area.saturating_add(area);
            if is_mean {
                cover.sum = cover.sum.saturating_add(i128::from(area) * i128::from(rounded(steps)));
                return Ok(());
            }
            // Rounding keeps the order.
            let [least, greatest] = part.range::<2>().map(|elevation| elevation.clamp(low, high) as f32);
            cover.least = cover.least.min(least);
            cover.greatest = cover.greatest.max(greatest);
            Ok(())
        })
    }

    /// Passes all tiles to `stages`; `cache` knows which cells are outside of the mask. Returns the number of
    /// tiles and the bytes in temporary files.
    pub(super) fn finish(mut self, cache: &TileCache, stages: &mut Stages) -> Result<[u64; 2]> {
        let mut values = vec![f32::NAN; CELLS];
        for at in places(cache.tiles()) {
            let Some(cells) = self.cells.read(at)? else { continue };
            for (value, cover) in values.iter_mut().zip(cells) {
                *value = match self.sample {
                    _ if cover.area == 0 => f32::NAN,
                    Sample::Min => cover.least,
                    Sample::Max => cover.greatest,
                    _ => mean(cover, self.steps_per_unit),
                };
            }
            cache.blank_outside(at, &mut values);
            stages.take(at, &values)?;
        }
        Ok([self.cells.spilled, self.cells.spill_len()])
    }
}

/// The nearest integer of a number up to 2^60. A call of the library would take as long as all else.
#[inline]
fn rounded(number: f64) -> i64 {
    // Numbers from 2^52 on are integers, to which a half would add an error.
    let half = if number.abs() < (1u64 << 52) as f64 { 0.5f64.copysign(number) } else { 0.0 };
    (number + half) as i64
}

/// The mean elevation, rounded at the end only.
fn mean(cover: &Cover, steps_per_unit: f64) -> f32 {
    let area = i128::from(cover.area);
    let (whole, rest) = (cover.sum.div_euclid(area), cover.sum.rem_euclid(area));
    ((whole as f64 + rest as f64 / area as f64) / steps_per_unit) as f32
}

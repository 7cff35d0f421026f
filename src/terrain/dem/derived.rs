//! Slopes, aspects and hillshades of filled cells.

use std::path::Path;

use foldhash::{HashMap, HashMapExt};

use super::fill::{Filler, around};
use super::flush::fill_holes;
use super::neighbours::{SIDE, place};
use super::options::Quantity;
use super::tile::Tile;
use super::tile_cache::TileCache;
use crate::files::{CELLS, TilePlace, places};
use spmesh_base::error::Result;
use spmesh_base::temporary::Records;
use spmesh_delaunay::predicates::Point2;
use spmesh_formats::raster::TILE;

/// The elevations of a raster whose holes are filled, from which the values of filled cells follow: by central
/// differences, or by differences to the only neighbour along an axis. A cell without neighbours along an axis has
/// no value.
///
/// Memory: that of the elevations; filled tiles are in a temporary file.
#[derive(Debug)]
pub(super) struct Derived {
    heights: TileCache,
    /// The records of tiles with filled cells.
    filled: HashMap<TilePlace, u32>,
    records: Records,
    quantity: Quantity,
    step: f64,
    window: Vec<f32>,
    tile: Vec<f32>,
}

impl Derived {
    /// Fills the holes of elevations; `step` is the side of a cell.
    pub(super) fn new(
        mut heights: TileCache,
        filler: &mut Filler,
        quantity: Quantity,
        step: f64,
        temp_dir: Option<&Path>,
    ) -> Result<Derived> {
        let mut records = Records::new(temp_dir, Tile::VALUES_LEN);
        let mut filled = HashMap::new();
        let mut values = vec![f32::NAN; CELLS];
        for at in places(heights.tiles()) {
            if heights.read(at, &mut values)?
                && fill_holes(&mut heights, filler, at, &mut |_, _| Ok(false), &mut values)?
            {
                let record = records.add();
                records.write("writing filled tiles", record, 0, bytemuck::cast_slice(&values))?;
                filled.insert(at, record);
            }
        }
        let [window, tile] = [SIDE * SIDE, CELLS].map(|count| vec![f32::NAN; count]);
        Ok(Derived { heights, filled, records, quantity, step, window, tile })
    }

    /// Sets the values of filled cells of a tile.
    pub(super) fn set(&mut self, at: TilePlace, values: &mut [f32]) -> Result<()> {
        if !self.filled.contains_key(&at) {
            return Ok(());
        }
        self.window.fill(f32::NAN);
        for [x, y] in around(at, self.heights.tiles()) {
            if self.read([x, y])? {
                place(&mut self.window, &self.tile, [x + 1 - at[0], y + 1 - at[1]]);
            }
        }
        // The elevations as drawn: cells without one are filled.
        self.heights.read(at, &mut self.tile)?;
        for (cell, value) in values.iter_mut().enumerate() {
            let in_window = (cell / TILE + 1) * SIDE + cell % TILE + 1;
            if self.tile[cell].is_nan() && !self.window[in_window].is_nan() {
                let gradient = self.gradient(in_window);
                if !gradient.iter().any(|part| part.is_nan()) {
                    *value = self.quantity.of_plane(gradient)?.unwrap_or(f32::NAN);
                }
            }
        }
        Ok(())
    }

    /// Reads the elevations of a tile; returns false for a blank tile.
    fn read(&mut self, at: TilePlace) -> Result<bool> {
        match self.filled.get(&at) {
            Some(&record) => {
                let bytes = bytemuck::cast_slice_mut(&mut self.tile);
                self.records.read("reading filled tiles back", record, 0, bytes).map(|()| true)
            }
            None => self.heights.read(at, &mut self.tile),
        }
    }

    /// The gradient at a cell of the window, to the east and the north; NaN along an axis without neighbours.
    fn gradient(&self, cell: usize) -> Point2 {
        let at = |cell: usize| f64::from(self.window[cell]);
        let along = |before: f64, after: f64| match (before.is_nan(), after.is_nan()) {
            (false, false) => (after - before) / (2.0 * self.step),
            (true, false) => (after - at(cell)) / self.step,
            (false, true) => (at(cell) - before) / self.step,
            (true, true) => f64::NAN,
        };
        [along(at(cell - 1), at(cell + 1)), along(at(cell + SIDE), at(cell - SIDE))]
    }
}

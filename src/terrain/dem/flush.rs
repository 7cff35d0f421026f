//! Writes the remaining tiles after the last triangle.

use super::derived::Derived;
use super::fill::Filler;
use super::options::Options;
use super::rasterizer::Rasterizer;
use super::stages::Stages;
use super::surroundings::Surroundings;
use super::tile::WORD;
use super::tile_cache::{TileCache, blank_others};
use crate::files::{TilePlace, places};
use spmesh_base::error::Result;
use spmesh_formats::raster::TILE;

/// Reads the values of a tile; returns false for a blank tile.
pub(super) type ReadTile<'a> = dyn FnMut(TilePlace, &mut [f32]) -> Result<bool> + 'a;

/// How holes are filled.
enum Holes {
    /// They are not.
    Kept,
    /// From values around them.
    Filled(Filler),
    /// From elevations around them.
    Derived(Box<Derived>),
}

/// The final pass over the tiles, which fills holes.
pub(super) struct Flush<'a> {
    cache: &'a mut TileCache,
    around: &'a Surroundings,
    holes: Holes,
    /// Number of filled cells.
    pub(super) filled: u64,
}

impl<'a> Flush<'a> {
    /// A pass over the tiles of a rasterizer.
    pub(super) fn new(
        rasterizer: &'a mut Rasterizer,
        filler: Option<Filler>,
        options: &Options,
        around: &'a Surroundings,
    ) -> Result<Flush<'a>> {
        let temp_dir = options.raster.temp_dir.as_deref();
        let holes = match (filler, rasterizer.heights.take()) {
            (None, _) => Holes::Kept,
            (Some(filler), None) => Holes::Filled(filler),
            (Some(mut filler), Some(heights)) => {
                let quantity = options.quantity.clone();
                let step = around.drawn.step / rasterizer.unit_of_z;
                Holes::Derived(Box::new(Derived::new(heights, &mut filler, quantity, step, temp_dir)?))
            }
        };
        Ok(Flush { cache: &mut rasterizer.cache, around, holes, filled: 0 })
    }

    /// Reads the final values of a tile; returns false for one without values. `read_written` reads tiles
    /// that were written.
    fn tile(&mut self, at: TilePlace, read_written: &mut ReadTile, values: &mut [f32]) -> Result<bool> {
        if !self.cache.read(at, values)? {
            return Ok(false);
        }
        let drawn = self.around.count_known(at, values);
        match &mut self.holes {
            Holes::Kept => {}
            Holes::Filled(filler) => {
                fill_holes(self.cache, filler, at, read_written, values)?;
            }
            Holes::Derived(derived) => derived.set(at, values)?,
        }
        self.filled += self.around.count_known(at, values) - drawn;
        Ok(values.iter().any(|value| !value.is_nan()))
    }

    /// Passes the tiles that were not written to `stages`, row by row, except blank ones.
    pub(super) fn write_rest(&mut self, stages: &mut Stages) -> Result<()> {
        let mut values = vec![f32::NAN; TILE * TILE];
        for at in places(self.cache.tiles()) {
            let is_left = !self.cache.is_written(at);
            if is_left && self.tile(at, &mut |at, values| stages.read(at, values), &mut values)? {
                stages.take(at, &values)?;
            }
        }
        Ok(())
    }
}

/// Fills the cells of a tile that have no value and lie inside of the outline; `values` are those of the tile
/// as drawn. Returns whether there are such cells near data.
pub(super) fn fill_holes(
    cache: &mut TileCache,
    filler: &mut Filler,
    at: TilePlace,
    read_written: &mut ReadTile,
    values: &mut [f32],
) -> Result<bool> {
    let mut kept = cache.read_outline(at)?;
    let is_inside = |cell: usize| kept[cell / WORD] >> (cell % WORD) & 1 == 1;
    if !values.iter().enumerate().any(|(cell, value)| value.is_nan() && is_inside(cell)) {
        return Ok(false);
    }
    // Cells on the border of the mesh have a value, although they belong to no triangle.
    for (cell, _) in values.iter().enumerate().filter(|(_, value)| !value.is_nan()) {
        kept[cell / WORD] |= 1 << (cell % WORD);
    }
    let tiles = cache.tiles();
    let read = |at: TilePlace, values: &mut [f32]| {
        if cache.is_written(at) { read_written(at, values) } else { cache.read(at, values) }
    };
    let is_near_data = filler.fill(at, tiles, read, values)?;
    blank_others(&kept, values);
    Ok(is_near_data)
}

//! The highest of several surfaces.

use std::io::{Read, Seek, Write};

use super::options::Options;
use super::surroundings::Surroundings;
use super::{Run, Stats, check};
use crate::files::{CELLS, Destination, TilePlace, TileSource, TileStore, TileTarget, places, tiles_of};
use spmesh_base::error::Result;
use spmesh_formats::raster::{Grid, Reference};
use spmesh_stream::{Crs, StreamReader};

/// In each cell, the greatest value of the meshes that have one there.
///
/// Memory: half of the budget of the options, and beside it the rest while a mesh is drawn.
#[derive(Debug)]
pub struct Highest {
    grid: Grid,
    store: TileStore,
    /// The tile that is there.
    tile: Vec<f32>,
}

impl Highest {
    /// No surfaces so far.
    ///
    /// # Errors
    /// Usage, if there are too many tiles.
    pub fn new(grid: &Grid, options: &Options) -> Result<Highest> {
        tiles_of(grid)?;
        let store = TileStore::new(1, options.memory / 2, options.raster.temp_dir.as_deref());
        Ok(Highest { grid: *grid, store, tile: vec![f32::NAN; CELLS] })
    }

    /// Adds the elevations of a mesh.
    ///
    /// # Errors
    /// As [`super::rasterize`].
    pub fn add<R: Read>(&mut self, reader: &mut StreamReader<R>, options: &Options) -> Result<Stats> {
        let header = reader.header().clone();
        let column = check(&header, &options.quantity).map_err(|e| e.of_input(reader.name()))?;
        let around = Surroundings::new(&self.grid, 0, None);
        // Heights have no slopes.
        let run = Run { around: &around, options, column, unit_of_z: 1.0 };
        run.draw(reader, self, options.memory / 2, |_| {})
    }

    /// Writes the raster, whose values are elevations or heights above something. Returns the number of cells
    /// with a value, and notices for the user.
    ///
    /// # Errors
    /// If writing fails.
    pub fn write<W: Write + Seek>(
        mut self,
        output: Destination<W>,
        options: &Options,
        crs: &Crs,
        has_elevations: bool,
    ) -> Result<(u64, Vec<String>)> {
        let mut reference = Reference::of_crs(crs, has_elevations, options.raster.format);
        let notices = std::mem::take(&mut reference.notices);
        let (file, grid) = (options.file(self.grid, &reference), self.grid);
        let around = Surroundings::new(&grid, 0, None);
        let (known, _) = output.write(&file, options.memory, |tiles, _| {
            let mut known = 0;
            for at in places(tiles_of(&grid)?) {
                if self.store.get(at, &mut self.tile)? {
                    known += around.count_known(at, &self.tile);
                    tiles.put(at, &self.tile)?;
                    self.store.remove(at);
                }
            }
            Ok(known)
        })?;
        Ok((known, notices))
    }
}

impl TileTarget for Highest {
    fn put(&mut self, at: TilePlace, values: &[f32]) -> Result<()> {
        if !self.store.get(at, &mut self.tile)? {
            return self.store.put(at, values);
        }
        // Of a number and NaN, the number counts.
        self.tile.iter_mut().zip(values).for_each(|(highest, value)| *highest = highest.max(*value));
        self.store.put(at, &self.tile)
    }
}

impl TileSource for Highest {
    fn get(&mut self, at: TilePlace, values: &mut [f32]) -> Result<bool> {
        self.store.get(at, values)
    }
}

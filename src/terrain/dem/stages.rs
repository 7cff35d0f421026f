//! What tiles go through after they are complete: derivation from their neighbours, then the target.

use super::neighbours::Neighbours;
use super::surroundings::Surroundings;
use crate::files::{CELLS, TilePlace, TileSource, TileTarget};
use spmesh_base::error::Result;
use spmesh_formats::raster::{Grid, TILE};
use spmesh_pipeline::finalize::Banks;

/// Takes complete tiles in any order, each once.
pub(super) struct Stages<'t> {
    neighbours: Option<Neighbours>,
    banks: Option<&'t Banks>,
    counted: Counted<'t>,
}

/// A target, and how many cells of the raster have a value. Tiles without any are skipped.
struct Counted<'t> {
    target: &'t mut dyn TileTarget,
    around: &'t Surroundings,
    known: u64,
}

impl TileTarget for Counted<'_> {
    fn put(&mut self, at: TilePlace, values: &[f32]) -> Result<()> {
        self.known += self.around.count_known(at, values);
        // A tile may be outside of the mask.
        let has_data = values.iter().any(|value| !value.is_nan());
        if has_data { self.target.put(at, values) } else { self.target.skip(at) }
    }

    fn skip(&mut self, at: TilePlace) -> Result<()> {
        self.target.skip(at)
    }
}

impl TileSource for Counted<'_> {
    fn get(&mut self, at: TilePlace, values: &mut [f32]) -> Result<bool> {
        self.target.get(at, values)
    }
}

impl<'t> Stages<'t> {
    /// The way to a target; through `neighbours` or `banks`, if there are any.
    pub(super) fn new(
        neighbours: Option<Neighbours>,
        target: &'t mut dyn TileTarget,
        around: &'t Surroundings,
        banks: Option<&'t Banks>,
    ) -> Stages<'t> {
        Stages { neighbours, banks, counted: Counted { target, around, known: 0 } }
    }

    /// Takes the values of a tile; NaN marks cells without data.
    pub(super) fn take(&mut self, at: TilePlace, values: &[f32]) -> Result<()> {
        match (&mut self.neighbours, self.banks) {
            (Some(neighbours), _) => neighbours.take(at, values, &mut self.counted),
            (None, Some(banks)) => {
                let depths = depths(banks, &self.counted.around.drawn, at, values);
                self.counted.put(at, &depths)
            }
            (None, None) => self.counted.put(at, values),
        }
    }

    /// Reads a tile back that went to the target unchanged; returns false if there is none.
    pub(super) fn read(&mut self, at: TilePlace, values: &mut [f32]) -> Result<bool> {
        self.counted.get(at, values)
    }

    /// Ends the stages. Returns how many cells have a value, and how many tiles and bytes are in temporary
    /// files.
    pub(super) fn finish(mut self) -> Result<[u64; 3]> {
        let mut spilled = [0; 2];
        if let Some(neighbours) = &mut self.neighbours {
            neighbours.finish(&mut self.counted)?;
            spilled = [neighbours.store().spilled, neighbours.store().spill_len()];
        }
        Ok([self.counted.known, spilled[0], spilled[1]])
    }
}

/// How far the cells of a tile are below the water, where they are on a shore.
fn depths(banks: &Banks, grid: &Grid, [column, row]: TilePlace, values: &[f32]) -> Vec<f32> {
    let depth = |(cell, &elevation): (usize, &f32)| {
        let [x, y] = [column * TILE + cell % TILE, row * TILE + cell / TILE];
        let depth = || banks.depth(grid.center(x as u32, y as u32), elevation);
        (!elevation.is_nan()).then(depth).flatten().unwrap_or(f32::NAN)
    };
    values[..CELLS].iter().enumerate().map(depth).collect()
}

//! What tiles go through after they are complete: derivation from their neighbours, then the target.

use super::neighbours::Neighbours;
use super::surroundings::Surroundings;
use crate::files::{TilePlace, TileSource, TileTarget};
use spmesh_base::error::Result;

/// Takes complete tiles in any order, each once.
pub(super) struct Stages<'t> {
    neighbours: Option<Neighbours>,
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
    /// The way to a target; through `neighbours`, if there are any.
    pub(super) fn new(
        neighbours: Option<Neighbours>,
        target: &'t mut dyn TileTarget,
        around: &'t Surroundings,
    ) -> Stages<'t> {
        Stages { neighbours, counted: Counted { target, around, known: 0 } }
    }

    /// Takes the values of a tile; NaN marks cells without data.
    pub(super) fn take(&mut self, at: TilePlace, values: &[f32]) -> Result<()> {
        match &mut self.neighbours {
            Some(neighbours) => neighbours.take(at, values, &mut self.counted),
            None => self.counted.put(at, values),
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

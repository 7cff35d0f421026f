//! Compresses tiles in order, on a separate thread.

use crate::raster::geotiff::overviews::TileName;
use crate::raster::geotiff::tile_code::{Encoded, TileCode};
use spmesh_base::error::Result;
use spmesh_base::parallel::OrderedPool;

/// Greatest number of tiles under way.
const TILES_MAX: u64 = 8;

/// A tile that is compressed.
pub(super) struct Compressed {
    pub(super) name: TileName,
    pub(super) encoded: Result<Encoded>,
    /// The buffer of its values, for reuse.
    pub(super) values: Vec<f32>,
}

/// A tile, the number of its cells along each axis that are in the image, and its values.
type Job = (TileName, [usize; 2], Vec<f32>);

/// The thread, and the tiles under way.
pub(super) struct Compressor {
    pool: OrderedPool<Job, Compressed>,
}

impl Compressor {
    /// Starts the thread.
    pub(super) fn start(code: TileCode) -> Result<Compressor> {
        let compress = move |(name, inside, values): Job| {
            let encoded = code.encode(&values, inside);
            Compressed { name, encoded, values }
        };
        Ok(Compressor { pool: OrderedPool::start("compressor", 1, TILES_MAX, compress)? })
    }

    /// Takes a tile. If [`TILES_MAX`] tiles are under way, returns the first of them.
    pub(super) fn push(
        &mut self,
        name: TileName,
        inside: [usize; 2],
        values: Vec<f32>,
    ) -> Option<Compressed> {
        let first = if self.pool.is_full() { self.pool.take() } else { None };
        self.pool.give((name, inside, values), 1);
        first
    }

    /// Waits for the first tile under way; `None` if there is none.
    pub(super) fn next(&mut self) -> Option<Compressed> {
        self.pool.take()
    }
}

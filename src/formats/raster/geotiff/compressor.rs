//! Compresses tiles in order, on a separate thread.

use crate::raster::geotiff::overviews::TileName;
use crate::raster::geotiff::tile_code::TileCode;
use spmesh_base::error::Result;
use spmesh_base::parallel::OrderedPool;

/// Greatest number of tiles under way.
const TILES_MAX: u64 = 8;

/// A tile that is compressed.
pub(super) struct Compressed {
    pub(super) name: TileName,
    pub(super) bytes: Vec<u8>,
    /// The buffer of its values, for reuse.
    pub(super) values: Vec<f32>,
}

/// The thread, and the tiles under way.
pub(super) struct Compressor {
    pool: OrderedPool<(TileName, Vec<f32>), Compressed>,
}

impl Compressor {
    /// Starts the thread.
    pub(super) fn start(code: TileCode) -> Result<Compressor> {
        let compress = move |(name, values): (TileName, Vec<f32>)| {
            let bytes = code.encode(&values);
            Compressed { name, bytes, values }
        };
        Ok(Compressor { pool: OrderedPool::start("compressor", 1, TILES_MAX, compress)? })
    }

    /// Takes a tile. If [`TILES_MAX`] tiles are under way, returns the first of them.
    pub(super) fn push(&mut self, name: TileName, values: Vec<f32>) -> Option<Compressed> {
        let first = if self.pool.is_full() { self.pool.take() } else { None };
        self.pool.give((name, values), 1);
        first
    }

    /// Waits for the first tile under way; `None` if there is none.
    pub(super) fn next(&mut self) -> Option<Compressed> {
        self.pool.take()
    }
}

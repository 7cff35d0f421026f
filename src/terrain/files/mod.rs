//! Files of rasters: complete tiles in, one file or many out.
//!
//! `tiles` says how tiles are passed on, and a `tile_store` holds them. `part` writes a file from tiles.
//! `division` divides a raster into `sheets`, and `dependencies` says when all tiles of a sheet have come.

mod dependencies;
mod division;
mod part;
mod sheets;
mod tile_store;
mod tiles;

use std::io::{Seek, Write};

pub(crate) use dependencies::Dependencies;
pub use division::{Division, SheetSize};
use sheets::Cutter;
pub use sheets::Sheets;
use spmesh_base::error::Result;
use spmesh_formats::raster::{self, RasterFile, RasterFormat};
pub(crate) use tile_store::TileStore;
pub(crate) use tiles::{CELLS, TilePlace, TileSource, TileTarget, places, tiles_of};

/// Where a raster goes.
#[derive(Debug)]
pub enum Destination<'o, W> {
    /// To one file.
    File(&'o mut W),
    /// To many files.
    Sheets(&'o mut Sheets),
}

impl<W: Write + Seek> Destination<'_, W> {
    /// Writes a raster of the tiles that `draw` supplies, which has the memory that is left to it. Returns
    /// what `draw` does, and how many tiles and bytes were in temporary files beside it.
    pub(crate) fn write<T>(
        self,
        file: &RasterFile,
        memory: u64,
        draw: impl FnOnce(&mut dyn TileTarget, u64) -> Result<T>,
    ) -> Result<(T, [u64; 2])> {
        let half = memory / 2;
        match self {
            Destination::File(output) if file.options.format == RasterFormat::GeoTiff => {
                let drawn = raster::write_tiles(output, file, |tiles| draw(tiles, memory))?;
                Ok((drawn, [0; 2]))
            }
            Destination::File(output) => {
                let temp_dir = file.options.temp_dir.as_deref();
                let mut store = TileStore::new(file.samples.bands(), half, temp_dir);
                let drawn = draw(&mut store, half)?;
                part::write(output, file, &mut store)?;
                Ok((drawn, [store.spilled, store.spill_len()]))
            }
            Destination::Sheets(sheets) => {
                let mut cutter = Cutter::new(sheets, file, half)?;
                let drawn = draw(&mut cutter, half)?;
                Ok((drawn, cutter.finish()?))
            }
        }
    }
}

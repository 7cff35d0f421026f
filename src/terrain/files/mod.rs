//! Files of rasters: complete tiles in, one file or many out.
//!
//! `tiles` says how tiles are passed on, and a `tile_store` holds them. `part` writes a file from tiles.
//! `division` divides a raster into `sheets`, whose `names` follow a pattern, and `dependencies` says when
//! all tiles of a sheet have come. `index` writes what describes all sheets.

mod dependencies;
mod division;
mod index;
mod names;
mod part;
mod sheet_table;
mod sheets;
mod tile_store;
mod tiles;

use std::io::{Seek, Write};
use std::ops::Range;

pub(crate) use dependencies::Dependencies;
pub use division::{Division, SheetSize};
pub use index::Index;
pub use names::Pattern;
use part::Part;
pub use sheet_table::SheetTable;
use sheets::Cutter;
pub use sheets::Sheets;
use spmesh_base::error::Result;
use spmesh_formats::raster::{self, Grid, RasterFile, RasterFormat};
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
        self.write_part(file, (&file.grid, &[0..file.grid.columns, 0..file.grid.rows]), memory, draw)
    }

    /// Writes a raster as [`Destination::write`] does, which has these columns and rows of the grid whose
    /// tiles `draw` supplies.
    pub(crate) fn write_part<T>(
        self,
        file: &RasterFile,
        (grid, cells): (&Grid, &[Range<u32>; 2]),
        memory: u64,
        draw: impl FnOnce(&mut dyn TileTarget, u64) -> Result<T>,
    ) -> Result<(T, [u64; 2])> {
        let half = memory / 2;
        match self {
            Destination::File(output)
                if file.options.format == RasterFormat::GeoTiff
                    && *grid == file.grid
                    && (!file.is_staged || file.is_readable()) =>
            {
                let drawn = raster::write_tiles(output, file, |tiles| draw(tiles, memory))?;
                Ok((drawn, [0; 2]))
            }
            Destination::File(output) => {
                let mut store = TileStore::new(file.samples.bands(), half, file.options.temp_dir.as_deref());
                let drawn = draw(&mut store, half)?;
                let file = RasterFile { is_staged: false, ..*file };
                let place = cells.each_ref().map(|cells| cells.start.into()..cells.end.into());
                let mut part = Part::new(&mut store, place, cells.clone(), file.samples.bands());
                part::write(output, &file, &mut part)?;
                Ok((drawn, [store.spilled, store.spill_len()]))
            }
            Destination::Sheets(sheets) => {
                let first = cells.each_ref().map(|cells| cells.start);
                let mut cutter = Cutter::new(sheets, file, grid, first, half)?;
                let drawn = draw(&mut cutter, half)?;
                Ok((drawn, cutter.finish()?))
            }
        }
    }
}

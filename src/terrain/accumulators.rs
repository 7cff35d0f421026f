//! What is kept for the cells of tiles: some tiles in memory, others in a temporary file.

use std::path::Path;

use bytemuck::Pod;
use foldhash::{HashMap, HashMapExt};

use crate::files::{CELLS, TilePlace, tiles_of};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::temporary::Records;
use spmesh_formats::raster::Grid;

/// A tile in memory.
#[derive(Debug)]
struct Held<C> {
    at: TilePlace,
    /// The clock at its last use.
    used: u64,
    cells: Vec<C>,
}

/// The cells of all tiles that something was added to.
///
/// Memory: the budget.
#[derive(Debug)]
pub(crate) struct Accumulators<C> {
    /// A cell that nothing was added to.
    blank: C,
    held: Vec<Held<C>>,
    held_max: usize,
    /// Where each tile is: its index in memory, or its record.
    places: HashMap<TilePlace, Place>,
    /// The tile that was used last, as [`packed`], and its index.
    last: (u64, usize),
    clock: u64,
    spill: Records,
    /// Number of tiles written to the temporary file.
    pub(crate) spilled: u64,
}

/// A place where tiles meet has so many. With fewer in memory, what is near it writes tiles and reads them
/// back in turn, which takes hours.
const HELD_MIN: usize = 4;

#[derive(Debug, Clone, Copy)]
enum Place {
    Held(usize),
    Spilled(u32),
}

/// No tile has this key: places are below 2^31.
const NOWHERE: u64 = u64::MAX;

/// The place of a tile as one number. Two numbers would be compared as one vector, which waits for both
/// stores: a sixth of the time of coverage.
#[inline]
fn packed([column, row]: TilePlace) -> u64 {
    (column as u64) << 32 | row as u64
}

impl<C: Pod> Accumulators<C> {
    /// Bytes of a tile.
    const TILE_LEN: u64 = (CELLS * size_of::<C>()) as u64;

    /// No cells of a raster. Those in memory take `memory` bytes at most.
    ///
    /// # Errors
    /// Memory, if this is too little for tiles that triangles and cells of points have in common.
    pub(crate) fn new(blank: C, grid: &Grid, memory: u64, temp_dir: Option<&Path>) -> Result<Self> {
        let [across, down] = tiles_of(grid)?;
        Self::with_tiles(blank, (across * down).min(HELD_MIN), memory, temp_dir)
    }

    /// No cells of a raster without an extent: its tiles may be anywhere.
    ///
    /// # Errors
    /// As [`Accumulators::new`].
    pub(crate) fn anywhere(blank: C, memory: u64, temp_dir: Option<&Path>) -> Result<Self> {
        Self::with_tiles(blank, HELD_MIN, memory, temp_dir)
    }

    fn with_tiles(blank: C, needed: usize, memory: u64, temp_dir: Option<&Path>) -> Result<Self> {
        let held_max = usize::try_from(memory / Self::TILE_LEN).unwrap_or(usize::MAX);
        if held_max < needed {
            let [tile, all] =
                [Self::TILE_LEN, Self::TILE_LEN * needed as u64].map(|len| len.div_ceil(1 << 10));
            let message = format!(
                "the sums of a tile of cells take {tile} KiB, those of {needed} tiles {all} KiB, and their part of \
                 --memory is {} KiB: raise it, or take larger cells",
                memory >> 10
            );
            return Err(Error::new(ErrorKind::Memory, message));
        }
        Ok(Accumulators {
            blank,
            held: Vec::new(),
            held_max,
            places: HashMap::new(),
            last: (NOWHERE, 0),
            clock: 0,
            spill: Records::new(temp_dir, Self::TILE_LEN),
            spilled: 0,
        })
    }

    /// A cell of a tile, to be changed.
    #[inline]
    pub(crate) fn cell(&mut self, at: TilePlace, cell: usize) -> Result<&mut C> {
        if self.last.0 != packed(at) {
            self.hold(at)?;
        }
        Ok(&mut self.held[self.last.1].cells[cell])
    }

    /// The cells of a tile; `None` if nothing was added to it.
    pub(crate) fn read(&mut self, at: TilePlace) -> Result<Option<&[C]>> {
        if !self.places.contains_key(&at) {
            return Ok(None);
        }
        let index = self.hold(at)?;
        Ok(Some(&self.held[index].cells))
    }

    /// Whether something was added to a tile.
    pub(crate) fn has(&self, at: TilePlace) -> bool {
        self.places.contains_key(&at)
    }

    /// The tiles that something was added to, row by row.
    pub(crate) fn tiles(&self) -> Vec<TilePlace> {
        let mut tiles: Vec<TilePlace> = self.places.keys().copied().collect();
        tiles.sort_unstable_by_key(|&[column, row]| [row, column]);
        tiles
    }

    /// Bytes of the temporary file.
    pub(crate) fn spill_len(&self) -> u64 {
        self.spill.file_len()
    }

    /// Brings a tile into memory, and returns its index there. It is the one used last.
    fn hold(&mut self, at: TilePlace) -> Result<usize> {
        let index = self.bring(at)?;
        self.last = (packed(at), index);
        Ok(index)
    }

    fn bring(&mut self, at: TilePlace) -> Result<usize> {
        self.clock += 1;
        let record = match self.places.get(&at) {
            Some(&Place::Held(index)) => {
                self.held[index].used = self.clock;
                return Ok(index);
            }
            Some(&Place::Spilled(record)) => Some(record),
            None => None,
        };
        let index = if self.held.len() < self.held_max {
            self.held.push(Held { at, used: 0, cells: vec![self.blank; CELLS] });
            self.held.len() - 1
        } else {
            self.evict()?
        };
        let held = &mut self.held[index];
        (held.at, held.used) = (at, self.clock);
        match record {
            Some(record) => {
                let bytes = bytemuck::cast_slice_mut(&mut held.cells);
                self.spill.read("reading cells back", record, 0, bytes)?;
                self.spill.forget(record);
            }
            None => held.cells.fill(self.blank),
        }
        self.places.insert(at, Place::Held(index));
        Ok(index)
    }

    /// Writes the tile that was used least recently to the temporary file, and returns its index.
    fn evict(&mut self) -> Result<usize> {
        let oldest = (0..self.held.len()).min_by_key(|&index| self.held[index].used).unwrap_or(0);
        let record = self.spill.add();
        let bytes = bytemuck::cast_slice(&self.held[oldest].cells);
        self.spill.write("writing cells that exceed --memory", record, 0, bytes)?;
        self.places.insert(self.held[oldest].at, Place::Spilled(record));
        self.spilled += 1;
        Ok(oldest)
    }
}

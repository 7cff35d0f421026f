//! The cells of tiles: some in memory, others in a temporary file.

use std::path::Path;

use foldhash::{HashMap, HashMapExt};

use super::statistic::{CELL_LEN, Cell};
use crate::dem::tile_cache::TilePlace;
use spmesh_core::error::Result;
use spmesh_core::temporary::Records;
use spmesh_io::raster::TILE;

/// Cells of a tile, and their length. Units: bytes.
const CELLS: usize = TILE * TILE;
const TILE_LEN: u64 = (CELLS * CELL_LEN) as u64;

/// A tile in memory.
#[derive(Debug)]
struct Held {
    at: TilePlace,
    /// The clock at its last use.
    used: u64,
    cells: Vec<Cell>,
}

/// The cells of all tiles that have points.
///
/// Memory: the budget, or one tile (4 MiB) if that is more.
#[derive(Debug)]
pub(super) struct Counters {
    held: Vec<Held>,
    held_max: usize,
    /// Where each tile is: its index in memory, or its record.
    places: HashMap<TilePlace, Place>,
    /// Index of the tile that was used last.
    last: usize,
    clock: u64,
    spill: Records,
    /// Number of tiles written to the temporary file.
    pub(super) spilled: u64,
}

#[derive(Debug, Clone, Copy)]
enum Place {
    Held(usize),
    Spilled(u32),
}

impl Counters {
    /// No cells. Those in memory take `memory` bytes at most.
    pub(super) fn new(memory: u64, temp_dir: Option<&Path>) -> Counters {
        Counters {
            held: Vec::new(),
            held_max: usize::try_from(memory / TILE_LEN).unwrap_or(usize::MAX).max(1),
            places: HashMap::new(),
            last: 0,
            clock: 0,
            spill: Records::new(temp_dir, TILE_LEN),
            spilled: 0,
        }
    }

    /// A cell of a tile, to be changed.
    ///
    /// # Errors
    /// If the temporary file fails.
    #[inline]
    pub(super) fn cell(&mut self, at: TilePlace, cell: usize) -> Result<&mut Cell> {
        if self.held.get(self.last).is_none_or(|held| held.at != at) {
            self.last = self.hold(at)?;
        }
        Ok(&mut self.held[self.last].cells[cell])
    }

    /// The cells of a tile; `None` if it has no points.
    ///
    /// # Errors
    /// If the temporary file fails.
    pub(super) fn read(&mut self, at: TilePlace) -> Result<Option<&[Cell]>> {
        if !self.places.contains_key(&at) {
            return Ok(None);
        }
        let index = self.hold(at)?;
        Ok(Some(&self.held[index].cells))
    }

    /// Brings a tile into memory, and returns its index there.
    fn hold(&mut self, at: TilePlace) -> Result<usize> {
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
            self.held.push(Held { at, used: 0, cells: vec![Cell::default(); CELLS] });
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
            None => held.cells.fill(Cell::default()),
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

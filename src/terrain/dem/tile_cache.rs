//! The tiles of a raster: some in memory, others in a temporary file.

use super::cell_mask::CellMask;
use super::tile::{Tile, WORDS_OF_TILE};
use crate::files::{TilePlace, tiles_of};
use spmesh_base::error::Result;
use spmesh_base::temporary::Records;
use spmesh_formats::raster::{Grid, TILE};
use std::path::Path;
use std::sync::Arc;

/// The action in the message when reading the temporary file fails.
const READING: &str = "reading tiles back";

/// Where the parts of a tile start in its record.
const STARTS: [u64; 3] = [0, Tile::VALUES_LEN, Tile::VALUES_LEN + Tile::BITS_LEN];

/// Where a tile is.
#[derive(Debug, Clone, Copy, PartialEq)]
enum State {
    /// No triangle has been drawn on it.
    Blank,
    /// In memory, with its index there.
    Held(u32),
    /// In the temporary file, with its record.
    Spilled(u32),
    /// All its cells belong to triangles, and it was written.
    Written,
}

/// A tile in memory.
#[derive(Debug)]
struct Held {
    number: usize,
    /// The clock at its last use.
    used: u64,
    tile: Tile,
}

/// All tiles of a grid.
///
/// Memory: the budget for tiles, and 8 bytes for each tile of the grid.
#[derive(Debug)]
pub(super) struct TileCache {
    grid: Grid,
    across: usize,
    states: Vec<State>,
    held: Vec<Held>,
    held_max: usize,
    /// Number of requests for a tile.
    clock: u64,
    spill: Records,
    /// Number of tiles written to the temporary file.
    pub(super) spilled: u64,
    /// A released tile, for reuse.
    spare: Option<Tile>,
    /// Cells outside of it have no data.
    mask: Option<Arc<CellMask>>,
}

impl TileCache {
    /// Blank tiles. Those in memory take `memory` bytes at most, or one tile if that is more. Cells outside of
    /// the mask have no data when they are read or taken.
    pub(super) fn new(
        grid: Grid,
        memory: u64,
        temp_dir: Option<&Path>,
        mask: Option<Arc<CellMask>>,
    ) -> Result<TileCache> {
        let [across, down] = tiles_of(&grid)?;
        Ok(TileCache {
            grid,
            across,
            states: vec![State::Blank; across * down],
            held: Vec::new(),
            held_max: usize::try_from(memory / Tile::LEN).unwrap_or(usize::MAX).max(1),
            clock: 0,
            spill: Records::new(temp_dir, Tile::LEN),
            spilled: 0,
            spare: None,
            mask,
        })
    }

    /// The number of tiles in a row, and in a column.
    pub(super) fn tiles(&self) -> [usize; 2] {
        [self.across, self.states.len() / self.across]
    }

    /// Length of the temporary file. Units: bytes.
    pub(super) fn spill_len(&self) -> u64 {
        self.spill.file_len()
    }

    /// A tile to draw on; `None` if it was written.
    pub(super) fn tile(&mut self, at: TilePlace) -> Result<Option<&mut Tile>> {
        let number = self.number(at);
        let place = match self.states[number] {
            State::Held(place) => place as usize,
            State::Written => return Ok(None),
            State::Blank => self.hold(number, None)?,
            State::Spilled(record) => self.hold(number, Some(record))?,
        };
        self.clock += 1;
        let held = &mut self.held[place];
        held.used = self.clock;
        Ok(Some(&mut held.tile))
    }

    /// Takes a complete tile out of memory, to be written. In a complete tile, all cells belong to triangles.
    pub(super) fn take_complete(&mut self, at: TilePlace) -> Option<Tile> {
        let number = self.number(at);
        let State::Held(place) = self.states[number] else { return None };
        let is_complete =
            self.held[place as usize].tile.owned_count() == self.inside(at).iter().product::<usize>() as u32;
        is_complete.then(|| {
            self.states[number] = State::Written;
            let mut tile = self.release(place as usize);
            self.blank_outside(at, &mut tile.values);
            tile
        })
    }

    /// Returns a tile from [`TileCache::take_complete`] for reuse.
    pub(super) fn recycle(&mut self, tile: Tile) {
        self.spare = Some(tile);
    }

    /// Whether a tile was complete and written.
    pub(super) fn is_written(&self, at: TilePlace) -> bool {
        self.states[self.number(at)] == State::Written
    }

    /// Reads the values of a tile without changing its state; returns false if it is blank or was written.
    pub(super) fn read(&mut self, at: TilePlace, values: &mut [f32]) -> Result<bool> {
        match self.states[self.number(at)] {
            State::Blank | State::Written => return Ok(false),
            State::Held(place) => values.copy_from_slice(&self.held[place as usize].tile.values),
            State::Spilled(record) => {
                self.spill.read(READING, record, 0, bytemuck::cast_slice_mut(values))?;
            }
        }
        self.blank_outside(at, values);
        Ok(true)
    }

    /// Reads which cells of a tile lie in triangles, holes included, and in the mask: a bit for each cell.
    pub(super) fn read_outline(&mut self, at: TilePlace) -> Result<Vec<u64>> {
        let mut bits = vec![0; 2 * WORDS_OF_TILE];
        match self.states[self.number(at)] {
            State::Blank | State::Written => {}
            State::Held(place) => bits = self.held[place as usize].tile.bits().concat(),
            State::Spilled(record) => {
                let bytes = bytemuck::cast_slice_mut(&mut bits);
                self.spill.read(READING, record, Tile::VALUES_LEN, bytes)?;
            }
        }
        let (owned, holes) = bits.split_at(WORDS_OF_TILE);
        let mut cells: Vec<u64> = owned.iter().zip(holes).map(|(owned, hole)| owned | hole).collect();
        if let Some(mask) = &self.mask {
            cells.iter_mut().zip(mask.tile(at)).for_each(|(cells, mask)| *cells &= mask);
        }
        Ok(cells)
    }

    /// Takes the values of cells outside of the mask away.
    pub(super) fn blank_outside(&self, at: TilePlace, values: &mut [f32]) {
        if let Some(mask) = &self.mask {
            blank_others(&mask.tile(at), values);
        }
    }

    fn number(&self, [column, row]: TilePlace) -> usize {
        row * self.across + column
    }

    /// The numbers of columns and rows of a tile inside the grid.
    pub(super) fn inside(&self, at: TilePlace) -> [usize; 2] {
        [(self.grid.columns, at[0]), (self.grid.rows, at[1])]
            .map(|(count, at)| (count as usize - at * TILE).min(TILE))
    }

    /// Puts a tile into memory and returns its index there.
    fn hold(&mut self, number: usize, record: Option<u32>) -> Result<usize> {
        if self.held.len() >= self.held_max {
            self.evict()?;
        }
        let mut tile = self.spare.take().unwrap_or_else(Tile::new);
        match record {
            Some(record) => {
                read(&mut self.spill, record, &mut tile)?;
                self.spill.forget(record);
            }
            None => tile.clear(),
        }
        self.states[number] = State::Held(self.held.len() as u32);
        self.held.push(Held { number, used: self.clock, tile });
        Ok(self.held.len() - 1)
    }

    /// Moves the least recently used tile to the temporary file.
    fn evict(&mut self) -> Result<()> {
        let oldest = (0..self.held.len()).min_by_key(|&place| self.held[place].used);
        let Some(place) = oldest else { return Ok(()) };
        let number = self.held[place].number;
        self.states[number] = State::Spilled(write(&mut self.spill, &self.held[place].tile)?);
        self.spilled += 1;
        self.spare = Some(self.release(place));
        Ok(())
    }

    /// Takes a tile out of memory; the last one moves to its index.
    fn release(&mut self, place: usize) -> Tile {
        let Held { tile, .. } = self.held.swap_remove(place);
        if let Some(moved) = self.held.get(place) {
            self.states[moved.number] = State::Held(place as u32);
        }
        tile
    }
}

/// Takes the values of cells away whose bit is not set.
pub(super) fn blank_others(cells: &[u64], values: &mut [f32]) {
    for (values, word) in values.chunks_mut(u64::BITS as usize).zip(cells) {
        let outside = values.iter_mut().enumerate().filter(|(bit, _)| word >> bit & 1 == 0);
        outside.for_each(|(_, value)| *value = f32::NAN);
    }
}

/// Writes a tile to the temporary file and returns the number of its record.
fn write(spill: &mut Records, tile: &Tile) -> Result<u32> {
    let record = spill.add();
    let what = "writing tiles that exceed --memory";
    for (bytes, start) in tile.bytes().into_iter().zip(STARTS) {
        spill.write(what, record, start, bytes)?;
    }
    Ok(record)
}

/// Reads a tile from the temporary file.
fn read(spill: &mut Records, record: u32, tile: &mut Tile) -> Result<()> {
    tile.fill(|parts| {
        parts.into_iter().zip(STARTS).try_for_each(|(bytes, start)| spill.read(READING, record, start, bytes))
    })
}

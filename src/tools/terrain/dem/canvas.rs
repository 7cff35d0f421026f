//! The tiles of a raster that triangles are drawn on: some in memory, others in a temporary file.

use std::path::Path;

use super::tile::Tile;
use spmesh_core::error::{Error, Result};
use spmesh_core::limits::RASTER_TILES_MAX;
use spmesh_core::temporary::Records;
use spmesh_io::raster::{Grid, TILE};

/// What is being done when reading the temporary file fails.
const READING: &str = "reading tiles back";

/// Column and row of a tile.
pub(super) type TilePlace = [usize; 2];

/// Where a tile is.
#[derive(Debug, Clone, Copy, PartialEq)]
enum State {
    /// No triangle has been drawn on it.
    Blank,
    /// In memory, with the number of its place there.
    Held(u32),
    /// In the temporary file, with its record.
    Spilled(u32),
    /// All its cells belong to triangles, and it was handed on.
    Complete,
}

/// A tile in memory.
#[derive(Debug)]
struct Held {
    number: usize,
    /// When it was drawn on last.
    used: u64,
    tile: Tile,
}

/// All tiles of a grid.
///
/// Memory: as many tiles as are allowed, and 8 bytes for each tile of the grid.
#[derive(Debug)]
pub(super) struct Canvas {
    grid: Grid,
    across: usize,
    states: Vec<State>,
    held: Vec<Held>,
    held_max: usize,
    /// Grows with each tile that is asked for.
    clock: u64,
    spill: Records,
    /// How many times a tile went to the temporary file.
    pub(super) spilled: u64,
    /// A tile that can be used again.
    spare: Option<Tile>,
}

impl Canvas {
    /// Blank tiles, of which those in memory take `memory` bytes at most, but for one that is always there.
    ///
    /// # Errors
    /// Usage, if there are more tiles than [`RASTER_TILES_MAX`].
    pub(super) fn new(grid: Grid, memory: u64, temp_dir: Option<&Path>) -> Result<Canvas> {
        let [across, down] = [grid.columns, grid.rows].map(|count| (count as usize).div_ceil(TILE));
        let count = across as u64 * down as u64;
        if count > RASTER_TILES_MAX {
            return Err(Error::usage(format!(
                "{} by {} cells of size {} are {count} tiles, at most {RASTER_TILES_MAX} are possible: take larger \
                 cells, or a part with --bounds",
                grid.columns, grid.rows, grid.step
            )));
        }
        Ok(Canvas {
            grid,
            across,
            states: vec![State::Blank; count as usize],
            held: Vec::new(),
            held_max: usize::try_from(memory / Tile::LEN).unwrap_or(usize::MAX).max(1),
            clock: 0,
            spill: Records::new(temp_dir, Tile::LEN),
            spilled: 0,
            spare: None,
        })
    }

    /// Number of tiles in a row, and in a column.
    pub(super) fn tiles(&self) -> [usize; 2] {
        [self.across, self.states.len() / self.across]
    }

    /// Bytes of the temporary file.
    pub(super) fn spill_len(&self) -> u64 {
        self.spill.file_len()
    }

    /// A tile, to be drawn on; nothing, if it was complete and handed on.
    ///
    /// # Errors
    /// If the temporary file fails.
    pub(super) fn tile(&mut self, at: TilePlace) -> Result<Option<&mut Tile>> {
        let number = self.number(at);
        let place = match self.states[number] {
            State::Held(place) => place as usize,
            State::Complete => return Ok(None),
            State::Blank => self.hold(number, None)?,
            State::Spilled(record) => self.hold(number, Some(record))?,
        };
        self.clock += 1;
        let held = &mut self.held[place];
        held.used = self.clock;
        Ok(Some(&mut held.tile))
    }

    /// Takes a tile in memory, if all of its cells belong to triangles: it is complete.
    pub(super) fn take_complete(&mut self, at: TilePlace) -> Option<Tile> {
        let number = self.number(at);
        let State::Held(place) = self.states[number] else { return None };
        let is_complete =
            self.held[place as usize].tile.owned_count() == self.inside(at).iter().product::<usize>() as u32;
        is_complete.then(|| {
            self.states[number] = State::Complete;
            self.let_go(place as usize)
        })
    }

    /// Gives back a tile that was taken.
    pub(super) fn give_back(&mut self, tile: Tile) {
        self.spare = Some(tile);
    }

    /// Whether no triangle has been drawn on a tile.
    pub(super) fn is_blank(&self, at: TilePlace) -> bool {
        self.states[self.number(at)] == State::Blank
    }

    /// Whether a tile was complete and handed on.
    pub(super) fn is_handed_on(&self, at: TilePlace) -> bool {
        self.states[self.number(at)] == State::Complete
    }

    /// Reads the values of a tile, which stays what it is; false if it is blank, or was handed on.
    ///
    /// # Errors
    /// If the temporary file fails.
    pub(super) fn read(&mut self, at: TilePlace, values: &mut [f32]) -> Result<bool> {
        match self.states[self.number(at)] {
            State::Blank | State::Complete => return Ok(false),
            State::Held(place) => values.copy_from_slice(&self.held[place as usize].tile.values),
            State::Spilled(record) => {
                self.spill.read(READING, record, 0, bytemuck::cast_slice_mut(values))?;
            }
        }
        Ok(true)
    }

    fn number(&self, [column, row]: TilePlace) -> usize {
        row * self.across + column
    }

    /// Number of columns and rows of a tile that are in the grid.
    pub(super) fn inside(&self, at: TilePlace) -> [usize; 2] {
        [(self.grid.columns, at[0]), (self.grid.rows, at[1])]
            .map(|(count, at)| (count as usize - at * TILE).min(TILE))
    }

    /// Puts a tile into memory; its place there.
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

    /// Sends the tile to the temporary file that was not drawn on for longest.
    fn evict(&mut self) -> Result<()> {
        let oldest = (0..self.held.len()).min_by_key(|&place| self.held[place].used);
        let Some(place) = oldest else { return Ok(()) };
        let number = self.held[place].number;
        self.states[number] = State::Spilled(write(&mut self.spill, &self.held[place].tile)?);
        self.spilled += 1;
        self.spare = Some(self.let_go(place));
        Ok(())
    }

    /// Takes a tile out of memory; the last one comes to its place.
    fn let_go(&mut self, place: usize) -> Tile {
        let Held { tile, .. } = self.held.swap_remove(place);
        if let Some(moved) = self.held.get(place) {
            self.states[moved.number] = State::Held(place as u32);
        }
        tile
    }
}

/// Keeps a tile in the temporary file; the number of its record.
fn write(spill: &mut Records, tile: &Tile) -> Result<u32> {
    let (record, [values, owned]) = (spill.add(), tile.bytes());
    let what = "writing tiles that exceed --memory";
    spill.write(what, record, 0, values)?;
    spill.write(what, record, Tile::VALUES_LEN, owned)?;
    Ok(record)
}

/// Reads a tile that was kept.
fn read(spill: &mut Records, record: u32, tile: &mut Tile) -> Result<()> {
    tile.fill(|[values, owned]| {
        spill.read(READING, record, 0, values)?;
        spill.read(READING, record, Tile::VALUES_LEN, owned)
    })
}

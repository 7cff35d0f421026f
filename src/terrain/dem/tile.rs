//! A tile of cells while triangles arrive.

use std::ops::Range;

use crate::files::CELLS;
use spmesh_base::error::Error;
use spmesh_formats::raster::TILE;

/// Bits of a word of the bit set.
pub(super) const WORD: usize = u64::BITS as usize;
/// Words of a row.
pub(super) const WORDS: usize = TILE / WORD;
/// Words of a tile.
pub(super) const WORDS_OF_TILE: usize = CELLS / WORD;

/// The values of cells, row by row, the set of cells that belong to triangles so far, and that of cells in holes.
///
/// Other cells may have a value, too: their centres are on the border of a triangle. If no triangle arrives
/// that they belong to, they are on the border of the mesh, and keep it.
#[derive(Debug, Clone)]
pub(super) struct Tile {
    /// NaN for cells without data.
    pub(super) values: Vec<f32>,
    /// A bit for each cell.
    owned: Vec<u64>,
    /// How many cells belong to triangles.
    owned_count: u32,
    /// A bit for each cell in a triangle that is left out.
    holes: Vec<u64>,
}

impl Tile {
    /// Length of the values. Units: bytes.
    pub(super) const VALUES_LEN: u64 = (CELLS * size_of::<f32>()) as u64;
    /// Length of a tile. Units: bytes.
    pub(super) const LEN: u64 = Tile::VALUES_LEN + 2 * Tile::BITS_LEN;
    /// Length of a bit set. Units: bytes.
    pub(super) const BITS_LEN: u64 = CELLS as u64 / 8;

    /// A blank tile.
    pub(super) fn new() -> Tile {
        Tile {
            values: vec![f32::NAN; CELLS],
            owned: vec![0; WORDS_OF_TILE],
            owned_count: 0,
            holes: vec![0; WORDS_OF_TILE],
        }
    }

    /// Blanks the tile.
    pub(super) fn clear(&mut self) {
        self.values.fill(f32::NAN);
        self.owned.fill(0);
        self.owned_count = 0;
        self.holes.fill(0);
    }

    /// How many cells belong to triangles.
    pub(super) fn owned_count(&self) -> u32 {
        self.owned_count
    }

    /// Which cells belong to triangles, and which are in holes: a bit for each, row by row.
    pub(super) fn bits(&self) -> [&[u64]; 2] {
        [&self.owned, &self.holes]
    }

    /// The tile as bytes in native order: the values, and both bit sets.
    pub(super) fn bytes(&self) -> [&[u8]; 3] {
        let [owned, holes] = self.bits().map(bytemuck::cast_slice);
        [bytemuck::cast_slice(&self.values), owned, holes]
    }

    /// Replaces the tile with the bytes that `fill` writes.
    pub(super) fn fill<E>(&mut self, fill: impl FnOnce([&mut [u8]; 3]) -> Result<(), E>) -> Result<(), E> {
        let [owned, holes] =
            [&mut self.owned, &mut self.holes].map(|bits| bytemuck::cast_slice_mut(&mut bits[..]));
        fill([bytemuck::cast_slice_mut(&mut self.values), owned, holes])?;
        self.owned_count = self.owned.iter().map(|word| word.count_ones()).sum();
        Ok(())
    }

    /// Marks cells of a row as part of a hole.
    pub(super) fn mark_hole(&mut self, row: usize, cells: Range<usize>) {
        for (word, bits) in words_of(cells) {
            self.holes[row * WORDS + word] |= bits;
        }
    }

    /// Marks cells of a row as owned by a triangle, and returns their values for it to set.
    #[inline]
    pub(super) fn own(&mut self, row: usize, cells: Range<usize>) -> Result<&mut [f32], Error> {
        for (word, bits) in words_of(cells.clone()) {
            let owned = &mut self.owned[row * WORDS + word];
            if *owned & bits != 0 {
                return Err(overlap());
            }
            *owned |= bits;
        }
        self.owned_count += cells.len() as u32;
        Ok(&mut self.values[row * TILE..][cells])
    }

    /// Gives a cell a value in case no triangle owns it. Of several values the least counts, so that their
    /// order does not matter.
    #[inline]
    pub(super) fn touch(&mut self, row: usize, column: usize, value: f32) {
        if self.owned[row * WORDS + column / WORD] & (1 << (column % WORD)) == 0 {
            let cell = &mut self.values[row * TILE + column];
            *cell = cell.min(value);
        }
    }
}

/// The words of a row with bits of some cells, at least one, and these bits.
#[inline]
fn words_of(cells: Range<usize>) -> impl Iterator<Item = (usize, u64)> {
    (cells.start / WORD..=(cells.end - 1) / WORD).map(move |word| {
        let start = cells.start.max(word * WORD) % WORD;
        let count = cells.end.min((word + 1) * WORD) - word * WORD - start;
        (word, (u64::MAX >> (WORD - count)) << start)
    })
}

/// The error of a cell that belongs to two triangles.
pub(super) fn overlap() -> Error {
    Error::malformed("triangles overlap: this is not a mesh in the plane, and a cell would have two values")
}

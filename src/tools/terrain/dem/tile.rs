//! The cells of a tile while triangles arrive.

use std::ops::Range;

use spmesh_core::error::Error;
use spmesh_io::raster::TILE;

/// Number of cells of a tile, those beyond the grid included.
pub(super) const CELLS: usize = TILE * TILE;

/// Bits of a word of a set.
const WORD: usize = u64::BITS as usize;
/// Words of a row.
const WORDS: usize = TILE / WORD;

/// Values of cells, row by row, and which of them belong to triangles that have arrived.
///
/// Others may have a value, too: their centres are on the border of a triangle. If no triangle that they belong to arrives, they are
/// on the border of the mesh, and keep it.
#[derive(Debug, Clone)]
pub(super) struct Tile {
    /// NaN where nothing is known.
    pub(super) values: Vec<f32>,
    /// A bit for each cell.
    owned: Vec<u64>,
    /// How many cells belong to triangles.
    owned_count: u32,
}

impl Tile {
    /// Bytes of its values.
    pub(super) const VALUES_LEN: u64 = (CELLS * size_of::<f32>()) as u64;
    /// Bytes of a tile.
    pub(super) const LEN: u64 = Tile::VALUES_LEN + CELLS as u64 / 8;

    /// A tile of which nothing is known.
    pub(super) fn new() -> Tile {
        Tile { values: vec![f32::NAN; CELLS], owned: vec![0; CELLS / WORD], owned_count: 0 }
    }

    /// Forgets all.
    pub(super) fn clear(&mut self) {
        self.values.fill(f32::NAN);
        self.owned.fill(0);
        self.owned_count = 0;
    }

    /// How many cells belong to triangles.
    pub(super) fn owned_count(&self) -> u32 {
        self.owned_count
    }

    /// All of it, as bytes of this process: values, and bits of cells.
    pub(super) fn bytes(&self) -> [&[u8]; 2] {
        [bytemuck::cast_slice(&self.values), bytemuck::cast_slice(&self.owned)]
    }

    /// Becomes what `fill` puts into the bytes of a tile.
    pub(super) fn fill<E>(&mut self, fill: impl FnOnce([&mut [u8]; 2]) -> Result<(), E>) -> Result<(), E> {
        fill([bytemuck::cast_slice_mut(&mut self.values), bytemuck::cast_slice_mut(&mut self.owned)])?;
        self.owned_count = self.owned.iter().map(|word| word.count_ones()).sum();
        Ok(())
    }

    /// Gives cells of a row to the triangle that they belong to; their values, to be written.
    ///
    /// # Errors
    /// If one of them belongs to another triangle.
    #[inline]
    pub(super) fn own(&mut self, row: usize, cells: Range<usize>) -> Result<&mut [f32], Error> {
        let (first, last) = (cells.start / WORD, (cells.end - 1) / WORD);
        for word in first..=last {
            let start = cells.start.max(word * WORD) % WORD;
            let count = cells.end.min((word + 1) * WORD) - word * WORD - start;
            let bits = (u64::MAX >> (WORD - count)) << start;
            let owned = &mut self.owned[row * WORDS + word];
            if *owned & bits != 0 {
                return Err(overlap());
            }
            *owned |= bits;
        }
        self.owned_count += cells.len() as u32;
        Ok(&mut self.values[row * TILE..][cells])
    }

    /// Gives a cell a value for the case that it belongs to no triangle: of several ones the least, so that their order does not
    /// matter.
    #[inline]
    pub(super) fn touch(&mut self, row: usize, column: usize, value: f32) {
        if self.owned[row * WORDS + column / WORD] & (1 << (column % WORD)) == 0 {
            let cell = &mut self.values[row * TILE + column];
            *cell = cell.min(value);
        }
    }
}

/// What is wrong if a cell belongs to two triangles.
pub(super) fn overlap() -> Error {
    Error::malformed("triangles overlap: this is no mesh in the plane, and a cell would have two values")
}

//! The cells of a tile while triangles arrive.

use crate::error::Error;
use crate::raster::TILE;

/// Number of cells of a tile, those beyond the grid included.
pub(super) const CELLS: usize = TILE * TILE;

/// Bits of a word of a set.
const WORD: usize = u64::BITS as usize;

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

    /// Gives a cell the value of the triangle that it belongs to.
    ///
    /// # Errors
    /// If it belongs to another one.
    #[inline]
    pub(super) fn own(&mut self, cell: usize, value: f32) -> Result<(), Error> {
        let (word, bit) = (&mut self.owned[cell / WORD], 1 << (cell % WORD));
        if *word & bit != 0 {
            return Err(overlap());
        }
        *word |= bit;
        self.owned_count += 1;
        self.values[cell] = value;
        Ok(())
    }

    /// Gives a cell a value for the case that it belongs to no triangle: of several ones the least, so that their order does not
    /// matter.
    #[inline]
    pub(super) fn touch(&mut self, cell: usize, value: f32) {
        if self.owned[cell / WORD] & (1 << (cell % WORD)) == 0 {
            self.values[cell] = self.values[cell].min(value);
        }
    }
}

/// What is wrong if a cell belongs to two triangles.
pub(super) fn overlap() -> Error {
    Error::malformed("triangles overlap: this is no mesh in the plane, and a cell would have two values")
}

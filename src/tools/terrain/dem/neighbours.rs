//! Slopes, aspects and hillshades from the elevations of a cell and its eight neighbours.
//!
//! A tile waits until the tiles around it are complete. At the end of the mesh, tiles that never came are blank.

use super::fill::around;
use super::options::Quantity;
use super::tile::CELLS;
use super::tile_cache::TilePlace;
use super::tile_store::{TileStore, TileTarget};
use spmesh_core::error::Result;
use spmesh_io::raster::{Gradient, TILE};

/// Cells along a side of the window: a tile, and a margin of one cell.
pub(super) const SIDE: usize = TILE + 2;

/// Derives tiles from tiles of elevations that come in any order.
///
/// Memory: that of the store, three bytes for each tile of the grid, and two tiles. Tiles wait only while a
/// neighbour is missing.
#[derive(Debug)]
pub(super) struct Neighbours {
    quantity: Quantity,
    gradient: Gradient,
    /// Number of tiles along each axis.
    tiles: [usize; 2],
    store: TileStore,
    /// For each tile, whether it has come, how many tiles around it and including it have not, and how many of
    /// these are not derived yet.
    has_come: Vec<bool>,
    missing: Vec<u8>,
    users: Vec<u8>,
    window: Vec<f32>,
    tile: Vec<f32>,
}

impl Neighbours {
    /// No tiles so far. The store is empty; `tiles` is the number of tiles in a row and in a column of the grid.
    pub(super) fn new(
        quantity: Quantity,
        gradient: Gradient,
        tiles: [usize; 2],
        store: TileStore,
    ) -> Neighbours {
        let places = || places(tiles);
        let counts: Vec<u8> = places().map(|at| around(at, tiles).count() as u8).collect();
        Neighbours {
            quantity,
            gradient,
            tiles,
            store,
            has_come: vec![false; counts.len()],
            missing: counts.clone(),
            users: counts,
            window: vec![f32::NAN; SIDE * SIDE],
            tile: vec![f32::NAN; CELLS],
        }
    }

    /// The tiles that wait.
    pub(super) fn store(&self) -> &TileStore {
        &self.store
    }

    /// Takes the elevations of a tile, and passes each tile that can now be derived to `target`.
    ///
    /// # Errors
    /// Those of `target`, and of the temporary file; usage, if gradients overflow.
    pub(super) fn take(
        &mut self,
        at: TilePlace,
        elevations: &[f32],
        target: &mut dyn TileTarget,
    ) -> Result<()> {
        self.store.put(at, elevations)?;
        self.come(at, target)
    }

    /// Derives the rest: tiles that have not come are blank.
    ///
    /// # Errors
    /// As [`Neighbours::take`].
    pub(super) fn finish(&mut self, target: &mut dyn TileTarget) -> Result<()> {
        places(self.tiles)
            .try_for_each(|at| if self.has_come[self.number(at)] { Ok(()) } else { self.come(at, target) })
    }

    /// Marks a tile as complete and derives those for which it was the last one.
    fn come(&mut self, at: TilePlace, target: &mut dyn TileTarget) -> Result<()> {
        let number = self.number(at);
        self.has_come[number] = true;
        for other in around(at, self.tiles) {
            let number = self.number(other);
            self.missing[number] -= 1;
            if self.missing[number] == 0 {
                self.derive(other, target)?;
            }
        }
        Ok(())
    }

    /// Derives a tile, and forgets the elevations that no tile needs any more.
    fn derive(&mut self, at: TilePlace, target: &mut dyn TileTarget) -> Result<()> {
        if self.store.get(at, &mut self.tile)? {
            self.window.fill(f32::NAN);
            place(&mut self.window, &self.tile, [1, 1]);
            for other in around(at, self.tiles).filter(|&other| other != at) {
                if self.store.get(other, &mut self.tile)? {
                    place(&mut self.window, &self.tile, [0, 1].map(|axis| other[axis] + 1 - at[axis]));
                }
            }
            for (row, values) in self.tile.chunks_exact_mut(TILE).enumerate() {
                let lines = [0, 1, 2].map(|line| &self.window[(row + line) * SIDE..][..SIDE]);
                derive_row(&self.quantity, &self.gradient, lines, values)?;
            }
            target.put(at, &self.tile)?;
        }
        for other in around(at, self.tiles) {
            let number = self.number(other);
            self.users[number] -= 1;
            if self.users[number] == 0 {
                self.store.remove(other);
            }
        }
        Ok(())
    }

    fn number(&self, [column, row]: TilePlace) -> usize {
        row * self.tiles[0] + column
    }
}

/// All places of a grid of tiles, row by row.
pub(super) fn places([across, down]: [usize; 2]) -> impl Iterator<Item = TilePlace> {
    (0..down).flat_map(move |row| (0..across).map(move |column| [column, row]))
}

/// Derives a row of cells from the lines of elevations above, in, and below it, with a cell more at each end. A cell
/// has no value if it or a neighbour has none, as on the border of the raster.
fn derive_row(
    quantity: &Quantity,
    gradient: &Gradient,
    lines: [&[f32]; 3],
    values: &mut [f32],
) -> Result<()> {
    let [above, here, below] = lines.map(|line| line.windows(3));
    for (((value, above), here), below) in values.iter_mut().zip(above).zip(here).zip(below) {
        let cells: [f32; 9] =
            [above[0], above[1], above[2], here[0], here[1], here[2], below[0], below[1], below[2]];
        // NaN spreads.
        *value = match cells.iter().sum::<f32>().is_nan() && cells.iter().any(|cell| cell.is_nan()) {
            true => f32::NAN,
            false => quantity.of_cells(gradient, &cells)?,
        };
    }
    Ok(())
}

/// Copies the part of a tile in the window; `at` is 1, 1 for the tile in the middle.
pub(super) fn place(window: &mut [f32], tile: &[f32], at: [usize; 2]) {
    // The first cell in the tile, its place in the window, and the number of cells.
    let part = |at: usize| match at {
        0 => (TILE - 1, 0, 1),
        1 => (0, 1, TILE),
        _ => (0, TILE + 1, 1),
    };
    let [(from_column, column, width), (from_row, row, height)] = at.map(part);
    for line in 0..height {
        let from = &tile[(from_row + line) * TILE + from_column..][..width];
        window[(row + line) * SIDE + column..][..width].copy_from_slice(from);
    }
}

//! Slopes, aspects and hillshades from the elevations of a cell and its eight neighbours.
//!
//! A tile waits until the tiles around it are complete. At the end of the mesh, tiles that never came are blank.

use super::fill::around;
use super::relief::Derivation;
use crate::files::{CELLS, Dependencies, TilePlace, TileSource, TileStore, TileTarget, places};
use spmesh_base::error::Result;
use spmesh_formats::raster::TILE;

/// Cells along a side of the window: a tile, and a margin of one cell.
pub(super) const SIDE: usize = TILE + 2;

/// Derives tiles from tiles of elevations that come in any order.
///
/// Memory: that of the store, nine bytes for each tile of the grid, and two tiles. Tiles wait only while a
/// neighbour is missing.
#[derive(Debug)]
pub(super) struct Neighbours {
    derivation: Derivation,
    /// Number of tiles along each axis.
    tiles: [usize; 2],
    store: TileStore,
    /// Each derived tile needs itself and the tiles around it.
    dependencies: Dependencies,
    window: Vec<f32>,
    tile: Vec<f32>,
    /// The values of a derived tile, band by band.
    values: Vec<f32>,
}

impl Neighbours {
    /// No tiles so far. The store is empty; `tiles` is the number of tiles in a row and in a column of the grid.
    pub(super) fn new(derivation: Derivation, tiles: [usize; 2], store: TileStore) -> Neighbours {
        let around = |count: usize| (0..count).map(|at| at.saturating_sub(1)..(at + 2).min(count)).collect();
        Neighbours {
            values: vec![f32::NAN; derivation.bands() * CELLS],
            derivation,
            tiles,
            store,
            dependencies: Dependencies::new(tiles, tiles.map(around)),
            window: vec![f32::NAN; SIDE * SIDE],
            tile: vec![f32::NAN; CELLS],
        }
    }

    /// The tiles that wait.
    pub(super) fn store(&self) -> &TileStore {
        &self.store
    }

    /// Takes the elevations of a tile, and passes each tile that can now be derived to `target`.
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
    pub(super) fn finish(&mut self, target: &mut dyn TileTarget) -> Result<()> {
        places(self.tiles)
            .try_for_each(|at| if self.dependencies.has_come(at) { Ok(()) } else { self.come(at, target) })
    }

    /// Marks a tile as complete and derives those for which it was the last one.
    fn come(&mut self, at: TilePlace, target: &mut dyn TileTarget) -> Result<()> {
        for tile in self.dependencies.come(at) {
            self.derive(tile, target)?;
            self.dependencies.made(tile).into_iter().for_each(|tile| self.store.remove(tile));
        }
        Ok(())
    }

    /// Derives a tile.
    fn derive(&mut self, at: TilePlace, target: &mut dyn TileTarget) -> Result<()> {
        if !self.store.get(at, &mut self.tile)? {
            return target.skip(at);
        }
        self.window.fill(f32::NAN);
        place(&mut self.window, &self.tile, [1, 1]);
        for other in around(at, self.tiles).filter(|&other| other != at) {
            if self.store.get(other, &mut self.tile)? {
                place(&mut self.window, &self.tile, [0, 1].map(|axis| other[axis] + 1 - at[axis]));
            }
        }
        for row in 0..TILE {
            let lines = [0, 1, 2].map(|line| &self.window[(row + line) * SIDE..][..SIDE]);
            self.derivation.row(lines, &mut self.values, row)?;
        }
        target.put(at, &self.values)
    }
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

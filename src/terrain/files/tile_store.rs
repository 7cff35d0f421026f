//! Values of tiles that are complete: some in memory, others in a temporary file.

use std::path::Path;

use foldhash::{HashMap, HashMapExt};

use super::tiles::{CELLS, TilePlace, TileSource, TileTarget};
use spmesh_base::error::Result;
use spmesh_base::temporary::Records;

/// Where the values of a tile are.
#[derive(Debug)]
enum Place {
    Held { values: Vec<f32>, used: u64 },
    Spilled(u32),
}

/// The values of tiles.
///
/// Memory: the budget, and some 50 bytes for each tile.
#[derive(Debug)]
pub(crate) struct TileStore {
    places: HashMap<TilePlace, Place>,
    held: usize,
    held_max: usize,
    /// Number of requests for a tile.
    clock: u64,
    spill: Records,
    /// Number of tiles written to the temporary file.
    pub(crate) spilled: u64,
    spare: Vec<Vec<f32>>,
}

impl TileStore {
    /// No tiles. Those in memory take `memory` bytes at most, or one tile if that is more; tiles have as many
    /// values for each cell as there are `bands`.
    pub(crate) fn new(bands: usize, memory: u64, temp_dir: Option<&Path>) -> TileStore {
        let tile_len = (bands * CELLS * size_of::<f32>()) as u64;
        TileStore {
            places: HashMap::new(),
            held: 0,
            held_max: usize::try_from(memory / tile_len).unwrap_or(usize::MAX).max(1),
            clock: 0,
            spill: Records::new(temp_dir, tile_len),
            spilled: 0,
            spare: Vec::new(),
        }
    }

    /// Whether there is a tile.
    pub(crate) fn holds(&self, at: TilePlace) -> bool {
        self.places.contains_key(&at)
    }

    /// Forgets a tile.
    pub(crate) fn remove(&mut self, at: TilePlace) {
        match self.places.remove(&at) {
            Some(Place::Held { values, .. }) => {
                self.held -= 1;
                self.spare.push(values);
            }
            Some(Place::Spilled(record)) => self.spill.forget(record),
            None => {}
        }
    }

    /// Length of the temporary file. Units: bytes.
    pub(crate) fn spill_len(&self) -> u64 {
        self.spill.file_len()
    }

    /// Moves the tile that was used least recently to the temporary file.
    fn evict(&mut self) -> Result<()> {
        let held = self.places.iter_mut().filter_map(|(&at, place)| match place {
            Place::Held { used, .. } => Some((*used, at)),
            Place::Spilled(_) => None,
        });
        // Times of use differ, so the order of the table does not matter.
        let Some((_, oldest)) = held.min() else { return Ok(()) };
        let record = self.spill.add();
        if let Some(Place::Held { values, .. }) = self.places.insert(oldest, Place::Spilled(record)) {
            self.spill.write(
                "writing tiles that exceed --memory",
                record,
                0,
                bytemuck::cast_slice(&values),
            )?;
            self.spare.push(values);
        }
        self.held -= 1;
        self.spilled += 1;
        Ok(())
    }
}

impl TileTarget for TileStore {
    fn put(&mut self, at: TilePlace, values: &[f32]) -> Result<()> {
        self.remove(at);
        if self.held >= self.held_max {
            self.evict()?;
        }
        self.clock += 1;
        let mut copy = self.spare.pop().unwrap_or_default();
        copy.clear();
        copy.extend_from_slice(values);
        self.places.insert(at, Place::Held { values: copy, used: self.clock });
        self.held += 1;
        Ok(())
    }
}

impl TileSource for TileStore {
    fn get(&mut self, at: TilePlace, values: &mut [f32]) -> Result<bool> {
        self.clock += 1;
        match self.places.get_mut(&at) {
            None => return Ok(false),
            Some(Place::Held { values: held, used }) => {
                *used = self.clock;
                values.copy_from_slice(held);
            }
            Some(Place::Spilled(record)) => {
                self.spill.read("reading tiles back", *record, 0, bytemuck::cast_slice_mut(values))?;
            }
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_come_back_from_memory_and_disk() {
        for memory in [0, 3 * 4 * CELLS as u64, u64::MAX] {
            let mut store = TileStore::new(1, memory, None);
            let places: Vec<TilePlace> = (0..10).map(|i| [i % 4, i / 4]).collect();
            let values = |at: TilePlace| vec![(at[0] + 10 * at[1]) as f32; CELLS];
            places.iter().for_each(|&at| store.put(at, &values(at)).unwrap());
            let mut found = vec![0.0; CELLS];
            for &at in places.iter().rev() {
                assert!(store.get(at, &mut found).unwrap());
                assert_eq!(found, values(at));
            }
            store.put(places[3], &values([9, 9])).unwrap();
            store.remove(places[4]);
            assert!(store.get(places[3], &mut found).unwrap() && found == values([9, 9]));
            assert!(!store.get(places[4], &mut found).unwrap());
            assert_eq!(store.spilled > 0, memory != u64::MAX);
        }
    }
}

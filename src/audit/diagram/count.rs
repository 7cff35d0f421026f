//! Faces of all cells, each counted once.

use super::Proof;
use super::violation::{Claim, Violation};

/// Different keys among many, with room for twice as many as there are.
///
/// Cost: a sort whenever the room is used up, so that a key is sorted a few times.
///
/// Memory: 8 N bytes per different key.
#[derive(Debug, Default)]
pub(super) struct Distinct<const N: usize> {
    keys: Vec<[u32; N]>,
    limit: usize,
}

/// Keys that are always put up with.
const ROOM: usize = 1 << 12;

impl<const N: usize> Distinct<N> {
    pub(super) fn add(&mut self, key: [u32; N]) {
        if self.keys.len() >= self.limit.max(ROOM) {
            let distinct = self.count();
            self.limit = 2 * distinct;
        }
        self.keys.push(key);
    }

    /// Number of different keys so far.
    pub(super) fn count(&mut self) -> usize {
        self.keys.sort_unstable();
        self.keys.dedup();
        self.keys.len()
    }
}

/// Proves Euler's relation of a ball.
pub(super) fn check_euler(proof: &Proof) -> Result<(), Violation> {
    let Proof { vertices, edges, polygons, facets, cells, .. } = *proof;
    if vertices + polygons + cells == edges + facets + 1 {
        return Ok(());
    }
    let message = format!(
        "{vertices} vertices - {edges} edges + {polygons} polygons - {facets} facets + {cells} cells is not 1"
    );
    Err(Violation::new(Claim::Euler, message))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_count_once_across_sorts() {
        let mut distinct = Distinct::default();
        (0..3 * ROOM as u32).for_each(|i| distinct.add([i % 5_000, i % 2]));
        assert_eq!(distinct.count(), 5_000);
        (0..40_000).for_each(|i| distinct.add([i % 20_000, i % 2]));
        assert_eq!(distinct.count(), 20_000);
    }
}

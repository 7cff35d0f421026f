//! The vertices of a mesh stream that a later patch may still use.

use foldhash::{HashMap, HashMapExt};

use super::event::Patch;
use spmesh_core::error::{Error, Result};
use spmesh_model::bounds::Point;

/// Number of shards, a power of two.
const SHARDS: usize = 64;

/// Vertices between their patch and their finalization, with a value `T` that the consumer keeps for each.
///
/// Memory grows with the width of the stream, not with its length.
#[derive(Debug)]
pub struct LiveVertices<T> {
    /// Shards, each of the vertices whose ids have the same low bits. A map doubles its memory when it is full,
    /// and needs both the old and the new while it does: of shards, only one at a time does.
    live: Vec<HashMap<u64, T>>,
    len: usize,
    local: Vec<(u64, T)>,
    live_max: usize,
}

impl<T> Default for LiveVertices<T> {
    fn default() -> Self {
        let live = (0..SHARDS).map(|_| HashMap::new()).collect();
        LiveVertices { live, len: 0, local: Vec::new(), live_max: 0 }
    }
}

impl<T: Copy> LiveVertices<T> {
    /// No vertices.
    #[must_use]
    pub fn new() -> Self {
        LiveVertices::default()
    }

    /// Adds the new vertices of `patch`, with the values that `value_of` gives them. Returns id and value of
    /// each local vertex, and forgets the vertices that the patch finalizes.
    ///
    /// # Errors
    /// [`spmesh_core::error::ErrorKind::Malformed`] if the patch uses a vertex that is finalized or unknown.
    pub fn enter(&mut self, patch: &Patch, mut value_of: impl FnMut(u64, Point) -> T) -> Result<&[(u64, T)]> {
        self.local.clear();
        for (&point, id) in patch.new.iter().zip(patch.first_id..) {
            self.local.push((id, value_of(id, point)));
        }
        for &id in &patch.imported {
            let Some(&value) = self.live[shard_of(id)].get(&id) else {
                return Err(Error::malformed(if id < patch.first_id {
                    format!("vertex {id} referenced after finalization")
                } else {
                    format!("vertex {id} referenced before it was written")
                }));
            };
            self.local.push((id, value));
        }
        self.live_max = self.live_max.max(self.len + patch.new.len());
        // Most vertices are finalized by the patch that brings them: these never enter the map.
        let mut finalized = patch.finalized.iter().peekable();
        for (local, &(id, value)) in (0..).zip(&self.local[..patch.new.len()]) {
            if finalized.next_if_eq(&&local).is_none() {
                self.live[shard_of(id)].insert(id, value);
                self.len += 1;
            }
        }
        for &local in finalized {
            self.remove(patch.id(local));
        }
        Ok(&self.local)
    }

    /// Forgets a live vertex that a residual point names, and returns its value: no later patch uses it.
    ///
    /// # Errors
    /// [`spmesh_core::error::ErrorKind::Malformed`] if the vertex is finalized or unknown, or was named
    /// before.
    pub fn retire(&mut self, id: u64) -> Result<T> {
        self.remove(id)
            .ok_or_else(|| Error::malformed(format!("residual point names vertex {id}, which is not live")))
    }

    fn remove(&mut self, id: u64) -> Option<T> {
        let removed = self.live[shard_of(id)].remove(&id);
        self.len -= usize::from(removed.is_some());
        removed
    }

    /// Ids and values of all live vertices, in any order.
    pub fn iter(&self) -> impl Iterator<Item = (u64, T)> + '_ {
        self.live.iter().flatten().map(|(&id, &value)| (id, value))
    }

    /// Whether a vertex is live, so that a later patch may use it.
    #[must_use]
    pub fn contains(&self, id: u64) -> bool {
        self.live[shard_of(id)].contains_key(&id)
    }

    /// Number of live vertices.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether no vertex is live.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Greatest number of vertices that were live at once: the width of the stream.
    #[must_use]
    pub fn live_max(&self) -> usize {
        self.live_max
    }
}

/// The shard of a vertex.
#[inline(always)]
fn shard_of(id: u64) -> usize {
    id as usize % SHARDS
}

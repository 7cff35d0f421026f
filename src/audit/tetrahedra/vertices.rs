//! The vertices between their patch and their finalization.

use std::collections::HashMap;

use foldhash::fast::RandomState;

use super::facets::Corner;
use crate::audit::check::{Check, Violation};
use crate::bounds::Point;
use crate::stream::Patch;

/// A vertex with the size of its link so far.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vertex {
    pub(super) id: u64,
    pub(super) at: Point,
    /// Tetrahedra that have it.
    pub(super) tetrahedra: u64,
    /// Edges that have it.
    pub(super) edges: u64,
    /// Open facets that have it.
    pub(super) open: u64,
}

impl Vertex {
    pub(super) fn corner(&self) -> Corner {
        Corner { id: self.id, at: self.at }
    }
}

/// Live vertices, and those of the patch at hand in the order of their local indices.
#[derive(Debug, Default)]
pub(super) struct Vertices {
    live: HashMap<u64, Vertex, RandomState>,
    pub(super) local: Vec<Vertex>,
    seen: u64,
    live_max: usize,
}

impl Vertices {
    /// Takes up the vertices of a patch.
    pub(super) fn enter(&mut self, patch: &Patch) -> Result<(), Violation> {
        self.local.clear();
        for (&at, id) in patch.new.iter().zip(patch.first_id..) {
            self.local.push(Vertex { id, at, tetrahedra: 0, edges: 0, open: 0 });
        }
        for id in &patch.imported {
            let Some(vertex) = self.live.remove(id) else {
                let message = format!("vertex {id} is used after it was finalized");
                return Err(Violation::new(Check::Finalization, message));
            };
            self.local.push(vertex);
        }
        self.seen += patch.new.len() as u64;
        self.live_max = self.live_max.max(self.live.len() + self.local.len());
        Ok(())
    }

    /// Gives the vertices that the patch finalizes to `finalize` and keeps the others.
    pub(super) fn leave(
        &mut self,
        patch: &Patch,
        mut finalize: impl FnMut(&Vertex) -> Result<(), Violation>,
    ) -> Result<(), Violation> {
        let mut finalized = patch.finalized.iter().map(|&local| local as usize).peekable();
        for (local, vertex) in self.local.iter().enumerate() {
            if finalized.next_if_eq(&local).is_some() {
                finalize(vertex)?;
            } else {
                self.live.insert(vertex.id, *vertex);
            }
        }
        self.local.clear();
        Ok(())
    }

    /// Whether a vertex is live, between two patches.
    pub(super) fn is_live(&self, id: u64) -> bool {
        self.live.contains_key(&id)
    }

    /// The vertex, if it is live, between two patches.
    pub(super) fn live(&self, id: u64) -> Option<&Vertex> {
        self.live.get(&id)
    }

    /// The live vertex with the smallest id that `is_wrong`.
    pub(super) fn first_live(&self, is_wrong: impl Fn(u64) -> bool) -> Option<&Vertex> {
        self.live.values().filter(|vertex| is_wrong(vertex.id)).min_by_key(|vertex| vertex.id)
    }

    /// Number of vertices so far.
    pub(super) fn seen(&self) -> u64 {
        self.seen
    }

    /// Most vertices that were live at once.
    pub(super) fn live_max(&self) -> usize {
        self.live_max
    }
}

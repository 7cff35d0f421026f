//! The vertices between their patch and their finalization.

use std::collections::HashMap;

use foldhash::fast::RandomState;

use super::check::{Check, Ledger, Violation};
use spmesh_model::bounds::Point;
use spmesh_stream::Patch;

/// A vertex with data about its star, the simplices that have it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vertex<S> {
    pub(super) id: u64,
    pub(super) at: Point,
    /// 0 without weights.
    pub(super) weight: f64,
    pub(super) star: S,
}

/// Live vertices, and the vertices of the current patch in the order of their local indices.
///
/// Memory: the width of the stream.
#[derive(Debug, Default)]
pub(super) struct Vertices<S> {
    live: HashMap<u64, Vertex<S>, RandomState>,
    pub(super) local: Vec<Vertex<S>>,
    seen: u64,
    live_max: usize,
}

impl<S: Copy + Default> Vertices<S> {
    /// Adds the vertices of a patch.
    pub(super) fn enter(&mut self, patch: &Patch, ledger: &mut Ledger) -> Result<(), Violation> {
        self.local.clear();
        for (&at, id) in patch.new.iter().zip(patch.first_id..) {
            self.local.push(Vertex { id, at, weight: 0.0, star: S::default() });
        }
        for id in &patch.imported {
            let Some(vertex) = self.live.remove(id) else {
                let message = format!("vertex {id} is used after it was finalized");
                return Err(Violation::new(Check::Finalization, message));
            };
            self.local.push(vertex);
        }
        ledger.add(Check::Finalization, patch.vertices() as u64);
        self.seen += patch.new.len() as u64;
        self.live_max = self.live_max.max(self.live.len() + self.local.len());
        Ok(())
    }

    /// Gives the new vertices of the patch their weights.
    pub(super) fn weigh(&mut self, weights: impl Iterator<Item = f64>) {
        self.local.iter_mut().zip(weights).for_each(|(vertex, weight)| vertex.weight = weight);
    }

    /// Passes the vertices that the patch finalizes to `finalize` and keeps the others.
    pub(super) fn leave(
        &mut self,
        patch: &Patch,
        mut finalize: impl FnMut(&Vertex<S>) -> Result<(), Violation>,
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

    /// The vertex, if it is live.
    pub(super) fn live(&self, id: u64) -> Option<&Vertex<S>> {
        self.live.get(&id)
    }

    /// The live vertex with the smallest id that `is_wrong`.
    pub(super) fn first_live(&self, is_wrong: impl Fn(&Vertex<S>) -> bool) -> Option<&Vertex<S>> {
        self.live.values().filter(|vertex| is_wrong(vertex)).min_by_key(|vertex| vertex.id)
    }

    /// Proves that no vertex is live any more.
    pub(super) fn check_finalized(&self) -> Result<(), Violation> {
        let Some(vertex) = self.first_live(|_| true) else { return Ok(()) };
        let message = format!("vertex {} is never finalized", vertex.id);
        Err(Violation::new(Check::Finalization, message).with(vertex.id, vertex.at))
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

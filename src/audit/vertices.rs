//! The vertices between their patch and their finalization.

use super::check::{Check, Ledger, Violation};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Ascending, Patch, Place};

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
#[derive(Debug)]
pub(super) struct Vertices<S> {
    /// Those that the current patch imports are here, too, as they were before it.
    live: Ascending<Vertex<S>>,
    pub(super) local: Vec<Vertex<S>>,
    /// Where the imported vertices of the current patch are.
    places: Vec<Place>,
    seen: u64,
    live_max: usize,
}

impl<S> Default for Vertices<S> {
    fn default() -> Self {
        let (live, local, places) = (Ascending::default(), Vec::new(), Vec::new());
        Vertices { live, local, places, seen: 0, live_max: 0 }
    }
}

impl<S: Copy + Default> Vertices<S> {
    /// Adds the vertices of a patch.
    pub(super) fn enter(&mut self, patch: &Patch, ledger: &mut Ledger) -> Result<(), Violation> {
        self.local.clear();
        for (&at, id) in patch.new.iter().zip(patch.first_id..) {
            self.local.push(Vertex { id, at, weight: 0.0, star: S::default() });
        }
        self.live.find_all(&patch.imported, &mut self.places).map_err(|id| {
            Violation::new(Check::Finalization, format!("vertex {id} is used after it was finalized"))
        })?;
        self.local.extend(self.places.iter().map(|&place| *self.live.at(place)));
        ledger.add(Check::Finalization, patch.vertices() as u64);
        self.seen += patch.new.len() as u64;
        self.live_max = self.live_max.max(self.live.len() + patch.new.len());
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
        let mut gone = 0;
        for (local, vertex) in self.local.iter().enumerate() {
            let place = local.checked_sub(patch.new.len());
            let is_finalized = finalized.next_if_eq(&local).is_some();
            match place {
                _ if is_finalized => finalize(vertex)?,
                Some(place) => *self.live.at_mut(self.places[place]) = *vertex,
                None => self.live.push(vertex.id, *vertex),
            }
            if let Some(place) = place.filter(|_| is_finalized) {
                // The places of those that are finalized move to the front.
                self.places[gone] = self.places[place];
                gone += 1;
            }
        }
        self.live.forget(&self.places[..gone]);
        self.local.clear();
        Ok(())
    }

    pub(super) fn live(&self, id: u64) -> Option<&Vertex<S>> {
        self.live.get(id)
    }

    /// The live vertex with the smallest id that `is_wrong`.
    pub(super) fn first_live(&self, is_wrong: impl Fn(&Vertex<S>) -> bool) -> Option<&Vertex<S>> {
        self.live.iter().map(|(_, vertex)| vertex).find(|vertex| is_wrong(vertex))
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

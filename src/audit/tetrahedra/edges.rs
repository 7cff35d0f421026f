//! The edges of open facets.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use foldhash::fast::RandomState;

/// Edges, each with the number of its open facets. An edge without open facets is dropped: tetrahedra
/// surround it.
///
/// Memory: three edges for two open facets.
#[derive(Debug, Default)]
pub(super) struct OpenEdges {
    facets: HashMap<[u64; 2], u32, RandomState>,
    seen: u64,
}

impl OpenEdges {
    /// Records that a tetrahedron opened both of its facets at an edge; returns whether the edge is new.
    pub(super) fn open_two(&mut self, edge: [u64; 2]) -> bool {
        debug_assert!(edge.is_sorted(), "increasing ids");
        match self.facets.entry(edge) {
            Entry::Vacant(place) => {
                place.insert(2);
                self.seen += 1;
                true
            }
            Entry::Occupied(mut facets) => {
                *facets.get_mut() += 2;
                false
            }
        }
    }

    /// Records that a tetrahedron closed both of its facets at an edge.
    pub(super) fn close_two(&mut self, edge: [u64; 2]) {
        let Entry::Occupied(mut facets) = self.facets.entry(edge) else {
            debug_assert!(false, "an open facet has open edges");
            return;
        };
        *facets.get_mut() -= 2;
        if *facets.get() == 0 {
            facets.remove();
        }
    }

    /// Number of edges so far. An edge that was dropped counts again if another tetrahedron has it.
    pub(super) fn seen(&self) -> u64 {
        self.seen
    }
}

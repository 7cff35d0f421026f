//! Faces between live vertices that were seen, and the edges of open facets: to count each once.

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};

use foldhash::fast::RandomState;

/// Edges (`N` = 2) or facets (`N` = 3) that a later tetrahedron may have too, as increasing ids.
///
/// Memory: twice the maximal number of faces between live vertices, or some thousand faces if that is more.
/// Faces of finalized vertices are swept out whenever the number of faces has doubled, so that a sweep costs
/// constant time per face.
#[derive(Debug, Default)]
pub(super) struct SeenFaces<const N: usize> {
    faces: HashSet<[u64; N], RandomState>,
    after_sweep: usize,
    seen: u64,
}

/// Fewer faces are not worth a sweep.
const SWEEP_LEN_MIN: usize = 1 << 12;

impl<const N: usize> SeenFaces<N> {
    pub(super) fn add(&mut self, face: [u64; N]) {
        debug_assert!(face.is_sorted(), "increasing ids");
        self.seen += u64::from(self.faces.insert(face));
    }

    /// Whether the face was added. Reliable as long as its vertices are live.
    pub(super) fn contains(&self, face: [u64; N]) -> bool {
        self.faces.contains(&face)
    }

    /// Forgets the faces of vertices that are not live, if that pays.
    pub(super) fn sweep(&mut self, is_live: impl Fn(u64) -> bool) {
        if self.faces.len() >= SWEEP_LEN_MIN.max(2 * self.after_sweep) {
            self.faces.retain(|face| face.iter().all(|&id| is_live(id)));
            self.after_sweep = self.faces.len();
        }
    }

    /// Number of faces so far.
    pub(super) fn seen(&self) -> u64 {
        self.seen
    }
}

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

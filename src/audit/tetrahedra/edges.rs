//! The edges between live vertices: to count each edge once.

use std::collections::HashSet;

use foldhash::fast::RandomState;

/// Edges that a later tetrahedron may have too.
///
/// Memory: up to twice as many as there have been between live vertices, and some thousand. Those of finalized
/// vertices are swept out each time that the number has doubled, so that forgetting costs a constant per edge.
#[derive(Debug, Default)]
pub(super) struct LiveEdges {
    edges: HashSet<[u64; 2], RandomState>,
    after_sweep: usize,
    seen: u64,
}

/// Fewer edges are not worth a sweep.
const SWEEP_LEN_MIN: usize = 1 << 12;

impl LiveEdges {
    /// Adds the edge between two vertices; whether it is new.
    pub(super) fn add(&mut self, a: u64, b: u64) -> bool {
        let is_new = self.edges.insert([a.min(b), a.max(b)]);
        self.seen += u64::from(is_new);
        is_new
    }

    /// Forgets the edges of vertices that are not live, if that pays.
    pub(super) fn sweep(&mut self, is_live: impl Fn(u64) -> bool) {
        if self.edges.len() >= SWEEP_LEN_MIN.max(2 * self.after_sweep) {
            self.edges.retain(|&[a, b]| is_live(a) && is_live(b));
            self.after_sweep = self.edges.len();
        }
    }

    /// Number of edges so far.
    pub(super) fn seen(&self) -> u64 {
        self.seen
    }
}

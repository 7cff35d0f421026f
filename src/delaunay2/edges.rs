//! Half-edges in a flat array: half-edge `e` and its twin `e ^ 1` are neighbours in it.

/// No half-edge, no vertex.
pub(super) const NIL: u32 = u32::MAX;
/// Corner number of half-edges with the outer face to their left.
pub(super) const OUTER: u32 = u32::MAX;

/// Corner number of half-edges whose triangle has not been extracted.
pub(super) const UNNUMBERED: u32 = u32::MAX - 1;

/// A directed edge. Sixteen bytes, so that a pair of twins never straddles a cache line.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(16))]
pub(super) struct HalfEdge {
    /// Vertex at the end; [`NIL`] marks a tombstone.
    pub(super) destination: u32,
    /// Next half-edge that leaves the same vertex, counterclockwise; in a tombstone, the next tombstone.
    pub(super) onext: u32,
    /// Next half-edge that leaves the same vertex, clockwise.
    pub(super) oprev: u32,
    /// Corner opposite to it in the triangle to its left, once extracted; [`UNNUMBERED`] before, [`OUTER`] for none.
    pub(super) corner: u32,
}

/// The half-edges of all triangulations that are being merged, with a free list threaded through deleted pairs.
#[derive(Debug)]
pub(super) struct Edges {
    half: Vec<HalfEdge>,
    tombstones: u32,
    live_pairs: usize,
}

impl Default for Edges {
    fn default() -> Edges {
        Edges { half: Vec::new(), tombstones: NIL, live_pairs: 0 }
    }
}

impl Edges {
    pub(super) fn clear(&mut self) {
        self.half.clear();
        self.tombstones = NIL;
        self.live_pairs = 0;
    }

    /// Undirected edges that are not deleted.
    pub(super) fn live_pairs(&self) -> usize {
        self.live_pairs
    }

    /// All half-edges, tombstones included.
    pub(super) fn half_edges(&self) -> &[HalfEdge] {
        &self.half
    }

    #[inline(always)]
    pub(super) fn half_edge(&self, e: u32) -> HalfEdge {
        self.half[e as usize]
    }

    #[inline(always)]
    pub(super) fn destination(&self, e: u32) -> u32 {
        self.half[e as usize].destination
    }

    #[inline(always)]
    pub(super) fn origin(&self, e: u32) -> u32 {
        self.destination(e ^ 1)
    }

    #[inline(always)]
    pub(super) fn onext(&self, e: u32) -> u32 {
        self.half[e as usize].onext
    }

    #[inline(always)]
    pub(super) fn oprev(&self, e: u32) -> u32 {
        self.half[e as usize].oprev
    }

    /// Next half-edge of the counterclockwise hull after `e`, which has the outer face to its right.
    #[inline(always)]
    pub(super) fn hull_next(&self, e: u32) -> u32 {
        self.onext(e ^ 1)
    }

    /// Half-edge of the counterclockwise hull before `e`.
    #[inline(always)]
    pub(super) fn hull_previous(&self, e: u32) -> u32 {
        self.oprev(e) ^ 1
    }

    #[inline(always)]
    pub(super) fn set_corner(&mut self, e: u32, corner: u32) {
        self.half[e as usize].corner = corner;
    }

    /// Adds an edge and returns its half from `u` to `v`.
    ///
    /// It comes right after `after` counterclockwise around `u` and its twin right before `before` around `v`;
    /// [`NIL`] stands for a vertex that has no edge yet.
    #[inline(always)]
    pub(super) fn connect(&mut self, u: u32, after: u32, v: u32, before: u32) -> u32 {
        let e = self.allocate();
        let (onext, oprev) = match after {
            NIL => (e, e),
            _ => {
                let onext = std::mem::replace(&mut self.half[after as usize].onext, e);
                self.half[onext as usize].oprev = e;
                (onext, after)
            }
        };
        self.half[e as usize] = HalfEdge { destination: v, onext, oprev, corner: UNNUMBERED };
        let twin = e ^ 1;
        let (onext, oprev) = match before {
            NIL => (twin, twin),
            _ => {
                let oprev = std::mem::replace(&mut self.half[before as usize].oprev, twin);
                self.half[oprev as usize].onext = twin;
                (before, oprev)
            }
        };
        self.half[twin as usize] = HalfEdge { destination: u, onext, oprev, corner: UNNUMBERED };
        e
    }

    /// Deletes `e` and its twin.
    #[inline(always)]
    pub(super) fn delete(&mut self, e: u32) {
        for e in [e, e ^ 1] {
            let HalfEdge { onext, oprev, .. } = self.half[e as usize];
            self.half[oprev as usize].onext = onext;
            self.half[onext as usize].oprev = oprev;
            self.half[e as usize].destination = NIL;
        }
        self.half[(e & !1) as usize].onext = self.tombstones;
        self.tombstones = e & !1;
        self.live_pairs -= 1;
    }

    #[inline(always)]
    fn allocate(&mut self) -> u32 {
        self.live_pairs += 1;
        if self.tombstones != NIL {
            let e = self.tombstones;
            self.tombstones = self.onext(e);
            return e;
        }
        let e = self.half.len() as u32;
        let blank = HalfEdge { destination: NIL, onext: NIL, oprev: NIL, corner: UNNUMBERED };
        self.half.extend_from_slice(&[blank, blank]);
        e
    }
}

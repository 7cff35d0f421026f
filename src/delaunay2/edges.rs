//! Half-edges in a flat array: half-edge `e` and its twin `e ^ 1` are neighbours in it.

use crate::huge_pages;
use bytemuck::{Pod, Zeroable};

/// No half-edge, no vertex.
pub(super) const NIL: u32 = u32::MAX;
/// Corner number of half-edges without a triangle to their left.
pub(super) const OUTER: u32 = u32::MAX;

/// A directed edge.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct HalfEdge {
    /// Vertex at the end.
    pub(super) destination: u32,
    /// Next half-edge that leaves the same vertex, counterclockwise.
    pub(super) onext: u32,
    /// Next half-edge that leaves the same vertex, clockwise.
    pub(super) oprev: u32,
    /// Corner opposite to it in the triangle to its left, once extracted; [`OUTER`] for none. In the first of a
    /// pair of tombstones, the next pair.
    pub(super) corner: u32,
}

/// Twins. The alignment keeps them in one cache line.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C, align(32))]
struct Pair([HalfEdge; 2]);

/// Memory for half-edges, to be used again.
#[derive(Debug, Default)]
pub(super) struct EdgeMemory {
    words: Vec<u32>,
}

impl EdgeMemory {
    /// No edges yet, and room for those of a triangulation of `points` points.
    ///
    /// A plane graph has at most 3 n edges, and what is being merged is one at any time. Fresh memory is zeroed by
    /// the system when it is touched, not here.
    pub(super) fn edges(&mut self, points: usize) -> Edges<'_> {
        const WORDS: usize = size_of::<Pair>() / size_of::<u32>();
        let words = (3 * points + 1) * WORDS;
        if self.words.len() < words {
            self.words = Vec::new();
            self.words = vec![0; words];
            huge_pages::ask(&mut self.words);
        }
        let (_, pairs, _) = bytemuck::pod_align_to_mut::<u32, Pair>(&mut self.words);
        Edges { half: bytemuck::cast_slice_mut(pairs), used: 0, tombstones: NIL }
    }
}

/// The half-edges of all triangulations that are being merged, with a free list threaded through deleted pairs.
#[derive(Debug)]
pub(super) struct Edges<'a> {
    half: &'a mut [HalfEdge],
    used: u32,
    tombstones: u32,
}

impl Edges<'_> {
    /// Has `work` done on a copy of this handle, which lives in registers.
    #[inline(always)]
    pub(super) fn locally<T>(&mut self, work: impl FnOnce(&mut Edges) -> T) -> T {
        let mut local = Edges { half: &mut *self.half, used: self.used, tombstones: self.tombstones };
        let result = work(&mut local);
        (self.used, self.tombstones) = (local.used, local.tombstones);
        result
    }

    /// All half-edges, tombstones included.
    pub(super) fn half_edges(&self) -> &[HalfEdge] {
        &self.half[..self.used as usize]
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

    /// The two half-edges that follow `e` counterclockwise around the triangle to its left.
    #[inline(always)]
    pub(super) fn left_face(&self, e: u32) -> (u32, u32) {
        (self.oprev(e ^ 1), self.onext(e) ^ 1)
    }

    /// Makes `e` no half-edge of a triangle: [`Edges::left_face`] then gives one of a lesser number.
    #[inline(always)]
    pub(super) fn exclude(&mut self, e: u32) {
        self.half[e as usize].onext = 1;
    }

    #[inline(always)]
    pub(super) fn corner(&self, e: u32) -> u32 {
        self.half[e as usize].corner
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
            _ => (self.onext(after), after),
        };
        self.link(e, v, onext, oprev);
        let twin = e ^ 1;
        let (onext, oprev) = match before {
            NIL => (twin, twin),
            _ => (before, self.oprev(before)),
        };
        self.link(twin, u, onext, oprev);
        e
    }

    /// Writes `e` and puts it between its neighbours around its origin, which may be itself.
    #[inline(always)]
    fn link(&mut self, e: u32, destination: u32, onext: u32, oprev: u32) {
        self.half[e as usize] = HalfEdge { destination, onext, oprev, corner: OUTER };
        self.half[onext as usize].oprev = e;
        self.half[oprev as usize].onext = e;
    }

    /// Deletes `e` and its twin.
    #[inline(always)]
    pub(super) fn delete(&mut self, e: u32) {
        for e in [e, e ^ 1] {
            let (onext, oprev) = (self.onext(e), self.oprev(e));
            self.half[oprev as usize].onext = onext;
            self.half[onext as usize].oprev = oprev;
            self.exclude(e);
        }
        self.set_corner(e & !1, self.tombstones);
        self.tombstones = e & !1;
    }

    #[inline(always)]
    fn allocate(&mut self) -> u32 {
        if self.tombstones == NIL {
            self.used += 2;
            return self.used - 2;
        }
        let e = self.tombstones;
        self.tombstones = self.corner(e);
        e
    }
}

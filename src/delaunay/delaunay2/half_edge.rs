//! Half-edges, as places in the flat array of triangles.

/// No triangle: beyond an edge of the hull, or at a vertex without triangles.
pub const NONE: u32 = u32::MAX;

/// Words of a triangle ([`super::Triangle`]): three vertices counterclockwise, an unused word, the
/// neighbouring half-edges opposite to the vertices, an unused word.
pub(super) const WORDS: usize = 8;
/// First of the words that hold the neighbouring half-edges.
pub(super) const NEIGHBOURS: u32 = 4;

/// A half-edge is the word of the vertex opposite to it; its triangle is the word of its first vertex.
pub(super) type HalfEdge = u32;

/// The two triangles that vertex `v` brings: there are always twice as many triangles as vertices, but for
/// four.
///
/// Vertices are numbered along a curve, so that what is close in the plane is close in memory.
#[inline(always)]
pub(super) fn triangles_of(v: u32) -> [HalfEdge; 2] {
    let first = 2 * v * WORDS as u32;
    [first, first + WORDS as u32]
}

#[inline(always)]
pub(super) fn triangle_of(h: HalfEdge) -> HalfEdge {
    h & !(WORDS as u32 - 1)
}

/// The number of the triangle of a half-edge in the array.
#[inline(always)]
pub(super) fn number_of(h: HalfEdge) -> u32 {
    h / WORDS as u32
}

/// Which corner of its triangle a half-edge is opposite to.
#[inline(always)]
pub(super) fn corner(h: HalfEdge) -> usize {
    (h & 3) as usize
}

/// The next half-edge of the same triangle, counterclockwise.
#[inline(always)]
pub(super) fn next(h: HalfEdge) -> HalfEdge {
    if h & 2 == 0 { h + 1 } else { h - 2 }
}

/// The half-edge of the same triangle before `h`.
#[inline(always)]
pub(super) fn previous(h: HalfEdge) -> HalfEdge {
    if h & 3 == 0 { h + 2 } else { h - 1 }
}

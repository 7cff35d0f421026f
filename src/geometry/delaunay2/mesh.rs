//! A triangulated sphere in a flat array: the plane and one vertex at infinity (thesis 4.3).

use super::triangulation::NONE;
use crate::predicates::Point2;

/// The vertex at infinity. Its coordinates are not numbers, so that no comparison of rounded values decides a test
/// of a triangle that has it as a corner: such tests fall through every filter.
pub(super) const INFINITE: u32 = 0;

/// Words of a triangle ([`super::Triangle`]): three vertices counterclockwise, a word to spare, the half-edges across
/// from the vertices, a word to spare.
pub(super) const WORDS: usize = 8;
const ACROSS: u32 = 4;

/// A half-edge is the word of the vertex opposite to it; its triangle is the word of its first vertex.
pub(super) type HalfEdge = u32;

/// The two triangles that vertex `v` brings: there are always twice as many triangles as vertices, but for four.
///
/// Vertices are numbered along a curve, so that what is close in the plane is close in memory.
#[inline(always)]
pub(super) fn triangles_of(v: u32) -> [HalfEdge; 2] {
    let first = 2 * v * WORDS as u32;
    [first, first + WORDS as u32]
}

/// The triangle of a half-edge.
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

/// Points and triangles. Vertices are numbered from 1 on; [`INFINITE`] is at index 0 of the points.
pub(super) struct Sphere<'a> {
    points: &'a [Point2],
    words: &'a mut [u32],
    blank: [HalfEdge; 4],
}

impl<'a> Sphere<'a> {
    /// The triangle of three points, which are counterclockwise, and the three infinite ones around it.
    pub(super) fn new(points: &'a [Point2], room: &'a mut [u32], [a, b, c]: [u32; 3]) -> Sphere<'a> {
        let ([i, j], [k, l]) = (triangles_of(b), triangles_of(c));
        let mut sphere = Sphere { points, words: room, blank: [i, j, k, l] };
        let ([inside, at_a], [at_b, at_c]) = (triangles_of(INFINITE), triangles_of(a));
        sphere.write(inside, [a, b, c], [at_a, at_b, at_c]);
        sphere.write(at_a, [INFINITE, c, b], [inside, at_c + 2, at_b + 1]);
        sphere.write(at_b, [INFINITE, a, c], [inside + 1, at_a + 2, at_c + 1]);
        sphere.write(at_c, [INFINITE, b, a], [inside + 2, at_b + 2, at_a + 1]);
        sphere
    }

    /// The first `count` triangles of the array.
    pub(super) fn triangles(count: usize) -> impl DoubleEndedIterator<Item = HalfEdge> {
        (0..count as u32).map(|number| number * WORDS as u32)
    }

    /// The triangles of the array that are never written.
    pub(super) fn blank(&self) -> [HalfEdge; 4] {
        self.blank
    }

    /// Number of triangles in the array, with those that are never written.
    pub(super) fn len(&self) -> usize {
        self.words.len() / WORDS
    }

    #[inline(always)]
    pub(super) fn point(&self, v: u32) -> Point2 {
        self.points[v as usize]
    }

    /// The vertex opposite to a half-edge.
    #[inline(always)]
    pub(super) fn opposite(&self, h: HalfEdge) -> u32 {
        self.words[h as usize]
    }

    /// The half-edge on the other side of the same edge.
    #[inline(always)]
    pub(super) fn across(&self, h: HalfEdge) -> HalfEdge {
        self.words[(h + ACROSS) as usize]
    }

    #[inline(always)]
    pub(super) fn set_across(&mut self, h: HalfEdge, across: HalfEdge) {
        self.words[(h + ACROSS) as usize] = across;
    }

    /// The vertices of triangle `t`.
    #[inline(always)]
    pub(super) fn vertices(&self, t: HalfEdge) -> [u32; 3] {
        let words = &self.words[t as usize..][..3];
        [words[0], words[1], words[2]]
    }

    /// Writes triangle `t`.
    #[inline(always)]
    pub(super) fn write(&mut self, t: HalfEdge, [a, b, c]: [u32; 3], [i, j, k]: [HalfEdge; 3]) {
        self.words[t as usize..][..WORDS].copy_from_slice(&[a, b, c, 0, i, j, k, 0]);
    }

    /// Replaces the vertices of triangle `t`.
    #[inline(always)]
    pub(super) fn set_vertices(&mut self, t: HalfEdge, vertices: [u32; 3]) {
        self.words[t as usize..][..3].copy_from_slice(&vertices);
    }

    /// Moves triangle `t` to the place of `to`, which is none any more.
    pub(super) fn move_triangle(&mut self, t: HalfEdge, to: HalfEdge) {
        let across = [t, t + 1, t + 2].map(|h| self.across(h));
        self.write(to, self.vertices(t), across);
        for (i, h) in (0..).zip(across).filter(|&(_, h)| h != NONE) {
            self.set_across(h, to + i);
        }
    }

    /// The half-edge opposite to the vertex at infinity, if `t` has it: the other side of an edge of the hull.
    #[inline(always)]
    pub(super) fn hull_side(&self, t: HalfEdge) -> Option<HalfEdge> {
        (t..t + 3).find(|&h| self.opposite(h) == INFINITE)
    }
}

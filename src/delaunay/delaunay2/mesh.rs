//! A triangulated sphere in a flat array: the plane and one vertex at infinity (thesis 4.3).

use super::half_edge::{HalfEdge, NEIGHBOURS, NONE, WORDS, triangles_of};
use crate::predicates::Point2;

/// The vertex at infinity. Its coordinates are not numbers, so that no comparison of rounded values decides a
/// test of a triangle that has it as a corner: such tests fall through every filter.
pub(super) const INFINITE: u32 = 0;

/// Points and triangles. Vertices are numbered from 1 on; [`INFINITE`] is at index 0 of the points.
pub(super) struct Mesh<'a> {
    points: &'a [Point2],
    words: &'a mut [u32],
    blank: [HalfEdge; 4],
}

impl<'a> Mesh<'a> {
    /// The triangle of three points, which are counterclockwise, and the three infinite ones around it.
    pub(super) fn new(points: &'a [Point2], words: &'a mut [u32], [a, b, c]: [u32; 3]) -> Mesh<'a> {
        let ([i, j], [k, l]) = (triangles_of(b), triangles_of(c));
        let mut mesh = Mesh { points, words, blank: [i, j, k, l] };
        let ([inside, at_a], [at_b, at_c]) = (triangles_of(INFINITE), triangles_of(a));
        mesh.write(inside, [a, b, c], [at_a, at_b, at_c]);
        mesh.write(at_a, [INFINITE, c, b], [inside, at_c + 2, at_b + 1]);
        mesh.write(at_b, [INFINITE, a, c], [inside + 1, at_a + 2, at_c + 1]);
        mesh.write(at_c, [INFINITE, b, a], [inside + 2, at_b + 2, at_a + 1]);
        mesh
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
    pub(super) fn neighbour(&self, h: HalfEdge) -> HalfEdge {
        self.words[(h + NEIGHBOURS) as usize]
    }

    #[inline(always)]
    pub(super) fn set_neighbour(&mut self, h: HalfEdge, neighbour: HalfEdge) {
        self.words[(h + NEIGHBOURS) as usize] = neighbour;
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
        let neighbours = [t, t + 1, t + 2].map(|h| self.neighbour(h));
        self.write(to, self.vertices(t), neighbours);
        for (i, h) in (0..).zip(neighbours).filter(|&(_, h)| h != NONE) {
            self.set_neighbour(h, to + i);
        }
    }

    /// The half-edge opposite to the vertex at infinity, if `t` has it: the other side of an edge of the
    /// hull.
    #[inline(always)]
    pub(super) fn hull_side(&self, t: HalfEdge) -> Option<HalfEdge> {
        (t..t + 3).find(|&h| self.opposite(h) == INFINITE)
    }
}

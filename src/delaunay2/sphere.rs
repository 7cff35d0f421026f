//! A triangulated sphere in a flat array: the plane and one vertex at infinity (thesis 4.3).

use crate::huge_pages;
use crate::predicates::Point2;

/// The vertex at infinity. Its coordinates are not numbers, so that no comparison of rounded values decides a test
/// of a triangle that has it as a corner: such tests fall through every filter.
pub(super) const INFINITE: u32 = 0;

/// Words of a triangle: three vertices counterclockwise, a word to spare, the half-edges across from the vertices, a
/// word to spare. Half a cache line.
const WORDS: usize = 8;
const SPARE: u32 = 3;
const ACROSS: u32 = 4;

/// A half-edge is the word of the vertex opposite to it; its triangle is the word of its first vertex.
pub(super) type HalfEdge = u32;

/// Triangle number `t` of the array, counting from 0.
#[inline(always)]
pub(super) fn triangle(t: u32) -> HalfEdge {
    t * WORDS as u32
}

/// The triangle of a half-edge.
#[inline(always)]
pub(super) fn triangle_of(h: HalfEdge) -> HalfEdge {
    h & !(WORDS as u32 - 1)
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

/// Memory for triangles, to be used again.
#[derive(Debug, Default)]
pub(super) struct SphereMemory {
    words: Vec<u32>,
}

impl SphereMemory {
    /// Room for the triangles of `vertices` points, to be written before they are read.
    ///
    /// Fresh memory is zeroed by the system when it is touched, not here.
    pub(super) fn room(&mut self, vertices: usize) -> &mut [u32] {
        /// Triangles at cache lines.
        #[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
        #[repr(C, align(32))]
        struct Triangle([u32; WORDS]);
        let words = (2 * vertices + 1) * WORDS;
        if self.words.len() < words {
            self.words = Vec::new();
            self.words = vec![0; words];
            huge_pages::ask(&mut self.words);
        }
        let (_, triangles, _) = bytemuck::pod_align_to_mut::<u32, Triangle>(&mut self.words);
        bytemuck::cast_slice_mut(triangles)
    }
}

/// Points and triangles. Vertices are numbered from 1 on; [`INFINITE`] is at index 0 of the points.
pub(super) struct Sphere<'a> {
    points: &'a [Point2],
    words: &'a mut [u32],
}

impl<'a> Sphere<'a> {
    /// The triangle of three points, which are counterclockwise, and the three infinite ones around it: triangles 0
    /// to 3 of `room`.
    pub(super) fn new(points: &'a [Point2], room: &'a mut [u32], [a, b, c]: [u32; 3]) -> Sphere<'a> {
        let mut sphere = Sphere { points, words: room };
        let rows = [
            ([a, b, c], [(1, 0), (2, 0), (3, 0)]),
            ([INFINITE, c, b], [(0, 0), (3, 2), (2, 1)]),
            ([INFINITE, a, c], [(0, 1), (1, 2), (3, 1)]),
            ([INFINITE, b, a], [(0, 2), (2, 2), (1, 1)]),
        ];
        for (t, (vertices, across)) in (0..).zip(rows) {
            sphere.write(triangle(t), vertices, across.map(|(t, corner)| triangle(t) + corner));
        }
        sphere
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

    /// The number given to triangle `t` by [`Sphere::set_number`].
    #[inline(always)]
    pub(super) fn number(&self, t: HalfEdge) -> u32 {
        self.words[(t + SPARE) as usize]
    }

    /// Numbers triangle `t`.
    #[inline(always)]
    pub(super) fn set_number(&mut self, t: HalfEdge, number: u32) {
        self.words[(t + SPARE) as usize] = number;
    }

    /// The half-edge opposite to the vertex at infinity, if `t` has it: the other side of an edge of the hull.
    #[inline(always)]
    pub(super) fn hull_side(&self, t: HalfEdge) -> Option<HalfEdge> {
        (t..t + 3).find(|&h| self.opposite(h) == INFINITE)
    }
}

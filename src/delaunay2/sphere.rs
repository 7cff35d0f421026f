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
    /// Room for the triangles of `vertices` vertices, that at infinity among them, to be written before they are read.
    ///
    /// Fresh memory is zeroed by the system when it is touched, not here.
    pub(super) fn room(&mut self, vertices: usize) -> &mut [u32] {
        /// Triangles at cache lines.
        #[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
        #[repr(C, align(32))]
        struct Triangle([u32; WORDS]);
        let words = 2 * vertices * WORDS;
        // Up to one triangle is lost to alignment.
        if self.words.len() < words + WORDS {
            self.words = Vec::new();
            self.words = vec![0; words + WORDS];
            huge_pages::ask(&mut self.words);
        }
        let (_, triangles, _) = bytemuck::pod_align_to_mut::<u32, Triangle>(&mut self.words);
        &mut bytemuck::cast_slice_mut(triangles)[..words]
    }
}

/// Points and triangles. Vertices are numbered from 1 on; [`INFINITE`] is at index 0 of the points.
pub(super) struct Sphere<'a> {
    points: &'a [Point2],
    words: &'a mut [u32],
}

impl<'a> Sphere<'a> {
    /// The triangle of three points, which are counterclockwise, and the three infinite ones around it.
    pub(super) fn new(points: &'a [Point2], room: &'a mut [u32], [a, b, c]: [u32; 3]) -> Sphere<'a> {
        let mut sphere = Sphere { points, words: room };
        let ([inside, at_a], [at_b, at_c]) = (triangles_of(INFINITE), triangles_of(a));
        sphere.write(inside, [a, b, c], [at_a, at_b, at_c]);
        sphere.write(at_a, [INFINITE, c, b], [inside, at_c + 2, at_b + 1]);
        sphere.write(at_b, [INFINITE, a, c], [inside + 1, at_a + 2, at_c + 1]);
        sphere.write(at_c, [INFINITE, b, a], [inside + 2, at_b + 2, at_a + 1]);
        for t in triangles_of(b).into_iter().chain(triangles_of(c)) {
            sphere.write(t, [INFINITE; 3], [t; 3]);
        }
        sphere
    }

    /// All triangles, and those that are left blank, with no finite vertex.
    pub(super) fn triangles(&self) -> impl Iterator<Item = HalfEdge> + use<> {
        (0..self.words.len() as u32).step_by(WORDS)
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

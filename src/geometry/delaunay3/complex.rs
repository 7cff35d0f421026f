//! A triangulated 3-sphere in a flat array: the tetrahedralization and one vertex at infinity (thesis 4.3).

use super::MAX_POINTS;
use super::slots::Slots;
use super::tetrahedralization::{Tetrahedron, Vertex, WORDS};
use crate::predicates::Point3;
use bytemuck::{Zeroable, cast_slice, cast_slice_mut};
use spmesh_model::simplex::TETRAHEDRON_FACETS;

/// First of the words that hold the neighbouring facets.
pub(super) const FIRST_NEIGHBOUR: usize = 4;

/// Tetrahedra per vertex that memory is reserved for at first: uniform points have 6.8, points of a surface
/// up to 9. Memory costs nothing until it is touched; enlarging it would cost a copy.
pub(super) const TETRAHEDRA_PER_VERTEX: usize = 9;

/// Flag of each vertex of a deleted tetrahedron: with it, a number is above those of all vertices.
pub(super) const DELETED: u32 = 1 << 31;
const _: () = assert!(MAX_POINTS < DELETED as usize);

/// A facet of a tetrahedron is the word of the vertex opposite to it; a tetrahedron is the word of its first
/// vertex.
pub(super) type Facet = u32;

/// For a facet that is entered, and for the place, as a bit, of the first of its corners as seen by who enters: the
/// corners in that order.
static ENTERED: [[[u8; 4]; 16]; 4] = entered();

const fn entered() -> [[[u8; 4]; 16]; 4] {
    let mut table = [[[0; 4]; 16]; 4];
    let mut corner = 0;
    while corner < 4 {
        let [f, g, h] = TETRAHEDRON_FACETS[corner];
        table[corner][1 << f] = [f as u8, h as u8, g as u8, 0];
        table[corner][1 << g] = [g as u8, f as u8, h as u8, 0];
        table[corner][1 << h] = [h as u8, g as u8, f as u8, 0];
        corner += 1;
    }
    table
}

/// The corners a, b, c of a tetrahedron that is entered through `facet`, of which a is the given vertex, in the order
/// seen by who enters.
#[inline(always)]
pub(super) fn facets_behind(corners: [u32; 4], facet: Facet, a: u32) -> [usize; 3] {
    let [f, g, h, _] = ENTERED[corner(facet)][places(corners, a)];
    [usize::from(f & 3), usize::from(g & 3), usize::from(h & 3)]
}

/// The places of a vertex among corners, a bit for each.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn places(corners: [u32; 4], vertex: u32) -> usize {
    use std::arch::x86_64::{
        _mm_castsi128_ps, _mm_cmpeq_epi32, _mm_loadu_si128, _mm_movemask_ps, _mm_set1_epi32,
    };
    // SAFETY: every x86-64 processor has these instructions, and four words are loaded.
    let mask = unsafe {
        let equal = _mm_cmpeq_epi32(_mm_loadu_si128(corners.as_ptr().cast()), _mm_set1_epi32(vertex as i32));
        _mm_movemask_ps(_mm_castsi128_ps(equal))
    };
    mask as usize & 15
}

/// The places of a vertex among corners, a bit for each.
#[cfg(not(target_arch = "x86_64"))]
#[inline(always)]
fn places(corners: [u32; 4], vertex: u32) -> usize {
    (0..4).fold(0, |places, i| places | usize::from(corners[i] == vertex) << i)
}

/// The tetrahedron of a facet.
#[inline(always)]
pub(super) fn tetrahedron_of(facet: Facet) -> u32 {
    facet & !(WORDS as u32 - 1)
}

/// Which corner of its tetrahedron a facet is opposite to.
#[inline(always)]
pub(super) fn corner(facet: Facet) -> usize {
    (facet & 3) as usize
}

/// Vertices and tetrahedra. The last vertex is that at infinity.
#[derive(Debug)]
pub(super) struct Complex<'s> {
    pub(super) vertices: Vec<Vertex>,
    pub(super) tetrahedra: Slots<'s>,
    /// Deleted tetrahedra, whose places are reused before the array grows.
    pub(super) free: Vec<u32>,
    /// Tetrahedra before this word belong to other parts, too, and stay as they are: see [`super::parts`].
    pub(super) frozen: u32,
}

impl<'s> Complex<'s> {
    /// The first tetrahedron, positively oriented, and the four infinite ones around it, in empty room for
    /// five at least.
    pub(super) fn new(vertices: Vec<Vertex>, mut tetrahedra: Slots<'s>, first: [u32; 4]) -> Complex<'s> {
        let infinite = vertices.len() as u32 - 1;
        let outer = TETRAHEDRON_FACETS.map(|corners| {
            let [a, b, c] = corners.map(|i| first[i]);
            [infinite, a, c, b]
        });
        for vertices in [first].into_iter().chain(outer) {
            tetrahedra.push(Tetrahedron { vertices, neighbours: [0; 4] });
        }
        let mut complex = Complex { vertices, tetrahedra, free: Vec::new(), frozen: 0 };
        complex.link_all();
        complex
    }

    /// Links all facets, comparing each with each: for a few tetrahedra.
    fn link_all(&mut self) {
        let facets: Vec<Facet> =
            self.words_of_tetrahedra().flat_map(|t| (0..4).map(move |i| t + i)).collect();
        let corners = |facet: Facet| {
            let vertices = self.corners(tetrahedron_of(facet));
            let mut corners = TETRAHEDRON_FACETS[corner(facet)].map(|i| vertices[i]);
            corners.sort_unstable();
            corners
        };
        let is_other = |f: Facet, g: Facet| f != g && corners(f) == corners(g);
        let other = |f: Facet| facets.iter().copied().find(|&g| is_other(f, g)).expect("a closed complex");
        let pairs: Vec<[Facet; 2]> = facets.iter().map(|&f| [f, other(f)]).collect();
        pairs.into_iter().for_each(|[facet, other]| self.set_neighbour(facet, other));
    }

    #[inline(always)]
    fn words(&self) -> &[u32] {
        cast_slice(&self.tetrahedra)
    }

    #[inline(always)]
    fn words_mut(&mut self) -> &mut [u32] {
        cast_slice_mut(&mut self.tetrahedra)
    }

    /// All tetrahedra, including deleted ones.
    pub(super) fn words_of_tetrahedra(&self) -> impl Iterator<Item = u32> + use<'s> {
        (0..self.words().len() as u32).step_by(WORDS)
    }

    /// The vertex at infinity.
    #[inline(always)]
    pub(super) fn infinite(&self) -> u32 {
        self.vertices.len() as u32 - 1
    }

    /// Where a vertex is.
    #[inline(always)]
    pub(super) fn point(&self, vertex: u32) -> Point3 {
        self.vertices[vertex as usize].at
    }

    /// The vertices of tetrahedron `t`.
    #[inline(always)]
    pub(super) fn corners(&self, t: u32) -> [u32; 4] {
        self.tetrahedra[t as usize / WORDS].vertices
    }

    /// The tetrahedron of a facet.
    #[inline(always)]
    pub(super) fn tetrahedron(&self, facet: Facet) -> &Tetrahedron {
        &self.tetrahedra[facet as usize / WORDS]
    }

    /// The vertex opposite to a facet.
    #[inline(always)]
    pub(super) fn opposite(&self, facet: Facet) -> u32 {
        self.words()[facet as usize]
    }

    /// The same facet as a facet of the neighbouring tetrahedron.
    #[inline(always)]
    pub(super) fn neighbour(&self, facet: Facet) -> Facet {
        self.words()[facet as usize + FIRST_NEIGHBOUR]
    }

    /// Sets the neighbouring facet, in this direction only.
    #[inline(always)]
    pub(super) fn set_neighbour(&mut self, facet: Facet, other: Facet) {
        self.words_mut()[facet as usize + FIRST_NEIGHBOUR] = other;
    }

    /// The facets beyond a tetrahedron that is entered through `facet`: across from its corners a, b, c, of which a
    /// is the given vertex, in the order seen by who enters.
    #[inline(always)]
    pub(super) fn neighbours_behind(&self, facet: Facet, a: u32) -> [Facet; 3] {
        let Tetrahedron { vertices, neighbours } = self.tetrahedron(facet);
        let [f, g, h] = facets_behind(*vertices, facet, a);
        [neighbours[f], neighbours[g], neighbours[h]]
    }

    /// Marks a tetrahedron as deleted; its neighbouring facets stay.
    #[inline(always)]
    pub(super) fn delete(&mut self, t: u32) {
        let vertices = &mut self.tetrahedra[t as usize / WORDS].vertices;
        *vertices = vertices.map(|v| v | DELETED);
    }

    /// Undoes [`Complex::delete`], if nothing was written since.
    pub(super) fn restore(&mut self, t: u32) {
        let vertices = &mut self.tetrahedra[t as usize / WORDS].vertices;
        *vertices = vertices.map(|v| v & !DELETED);
    }

    /// Whether a tetrahedron is deleted.
    #[inline(always)]
    pub(super) fn is_deleted(&self, t: u32) -> bool {
        self.corners(t)[0] >= DELETED
    }

    /// Whether there is room for so many tetrahedra.
    #[inline(always)]
    pub(super) fn has_room(&self, count: usize) -> bool {
        count <= self.free.len() + self.tetrahedra.left()
    }

    /// The place of a tetrahedron yet to be written: one that was deleted, or a new one, for which there must
    /// be room.
    #[inline(always)]
    pub(super) fn allocate(&mut self) -> u32 {
        if let Some(slot) = self.free.pop() {
            return slot;
        }
        let slot = self.tetrahedra.len();
        self.tetrahedra.push(Tetrahedron::zeroed());
        (slot * WORDS) as u32
    }

    /// Writes a tetrahedron.
    #[inline(always)]
    pub(super) fn write(&mut self, t: u32, vertices: [u32; 4], neighbours: [Facet; 4]) {
        self.tetrahedra[t as usize / WORDS] = Tetrahedron { vertices, neighbours };
    }

    /// The facet of tetrahedron `t` on the hull, if `t` is infinite.
    #[inline(always)]
    pub(super) fn hull_facet(&self, t: u32) -> Option<Facet> {
        let infinite = self.infinite();
        self.corners(t).iter().position(|&v| v == infinite).map(|i| t + i as u32)
    }
}

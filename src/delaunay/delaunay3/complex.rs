//! A triangulated 3-sphere in a flat array: the tetrahedralization and one vertex at infinity (thesis 4.3).

use super::MAX_POINTS;
use super::tetrahedralization::{Vertex, WORDS};
use super::words::Words;
use crate::predicates::Point3;
use crate::simplex::TETRAHEDRON_FACETS;
use std::ops::Range;

/// First of the words that hold the neighbouring facets.
pub(super) const FIRST_NEIGHBOUR: usize = 4;

/// Tetrahedra per vertex that memory is reserved for at first: uniform points have 6.8, those of a gyroid
/// 9.3, infinite and deleted ones come in addition. Memory costs nothing until it is touched; enlarging it
/// would cost a copy, and threads without room refuse points.
pub(super) const TETRAHEDRA_PER_VERTEX: usize = 11;

/// Flag of each vertex of a deleted tetrahedron: with it, a number is above those of all vertices.
pub(super) const DELETED: u32 = 1 << 31;

/// Flag of each vertex of a frozen tetrahedron, which stays as it is while parts change: see
/// [`super::parts`].
pub(super) const FROZEN: u32 = 1 << 30;

/// A vertex without flags.
pub(super) const VERTEX: u32 = FROZEN - 1;
const _: () = assert!(MAX_POINTS < VERTEX as usize);

/// A facet of a tetrahedron is the word of the vertex opposite to it; a tetrahedron is the word of its first
/// vertex.
pub(super) type Facet = u32;

/// For a facet that is entered, and for the place, as a bit, of the first of its corners as seen by who
/// enters: the corners in that order.
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

/// The corners a, b, c of a tetrahedron that is entered through `facet`, of which a is the given vertex, in
/// the order seen by who enters.
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

#[inline(always)]
pub(super) fn tetrahedron_of(facet: Facet) -> u32 {
    facet & !(WORDS as u32 - 1)
}

/// Which corner of its tetrahedron a facet is opposite to.
#[inline(always)]
pub(super) fn corner(facet: Facet) -> usize {
    (facet & 3) as usize
}

/// The vertices, and the tetrahedra of which a thread may change some: all, or those of a part.
#[derive(Debug)]
pub(super) struct Complex<'s> {
    /// All vertices; the last one is that at infinity.
    pub(super) vertices: &'s [Vertex],
    /// The finite vertices of the part.
    pub(super) own: Range<u32>,
    /// Of each of them, and behind them of the vertex at infinity, its number among the vertices of a cavity;
    /// arbitrary if it is not one of them.
    pub(super) numbers: Vec<u32>,
    pub(super) words: Words<'s>,
    /// Deleted tetrahedra, whose places are used first.
    pub(super) free: Vec<u32>,
    /// Room that no tetrahedron has been in yet, as numbers of tetrahedra.
    pub(super) fresh: Range<usize>,
}

impl Complex<'_> {
    /// Writes the first tetrahedron, positively oriented, and the four infinite ones around it, at the start
    /// of the room, which is empty.
    pub(super) fn begin(&mut self, first: [u32; 4]) {
        let infinite = self.infinite();
        let outer = TETRAHEDRON_FACETS.map(|corners| {
            let [a, b, c] = corners.map(|i| first[i]);
            [infinite, a, c, b]
        });
        let all: Vec<u32> = [first]
            .into_iter()
            .chain(outer)
            .map(|vertices| {
                let t = self.allocate();
                self.write(t, vertices, [0; 4]);
                t
            })
            .collect();
        self.link_all(&all);
    }

    /// Links all facets of tetrahedra, comparing each with each: for a few.
    fn link_all(&mut self, tetrahedra: &[u32]) {
        let facets: Vec<Facet> = tetrahedra.iter().flat_map(|t| (0..4).map(move |i| t + i)).collect();
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

    /// Where the number of a vertex of the part, or of that at infinity, is.
    #[inline(always)]
    pub(super) fn place_of_number(&self, vertex: u32) -> usize {
        vertex.wrapping_sub(self.own.start).min(self.own.end - self.own.start) as usize
    }

    /// The vertices of tetrahedron `t`, with their flags.
    #[inline(always)]
    pub(super) fn corners(&self, t: u32) -> [u32; 4] {
        self.words.four(t as usize)
    }

    /// The vertices of a tetrahedron that may be frozen.
    pub(super) fn corners_of_any(&self, t: u32) -> [u32; 4] {
        self.corners(t).map(|v| v & VERTEX)
    }

    /// The vertex opposite to a facet, with its flags.
    #[inline(always)]
    pub(super) fn opposite(&self, facet: Facet) -> u32 {
        self.words.get(facet as usize)
    }

    /// The facets of the neighbours of tetrahedron `t`.
    #[inline(always)]
    pub(super) fn neighbours(&self, t: u32) -> [Facet; 4] {
        self.words.four(t as usize + FIRST_NEIGHBOUR)
    }

    /// The same facet as a facet of the neighbouring tetrahedron.
    #[inline(always)]
    pub(super) fn neighbour(&self, facet: Facet) -> Facet {
        self.words.get(facet as usize + FIRST_NEIGHBOUR)
    }

    /// Sets the neighbouring facet, in this direction only.
    #[inline(always)]
    pub(super) fn set_neighbour(&mut self, facet: Facet, other: Facet) {
        self.words.set(facet as usize + FIRST_NEIGHBOUR, other);
    }

    /// The facets beyond a tetrahedron that is entered through `facet`: across from its corners a, b, c, of
    /// which a is the given vertex, with its flags, in the order seen by who enters.
    #[inline(always)]
    pub(super) fn neighbours_behind(&self, facet: Facet, a: u32) -> [Facet; 3] {
        let t = tetrahedron_of(facet);
        let [f, g, h] = facets_behind(self.corners(t), facet, a);
        let first = t as usize + FIRST_NEIGHBOUR;
        [self.words.get(first + f), self.words.get(first + g), self.words.get(first + h)]
    }

    /// Marks a tetrahedron as deleted; its neighbouring facets stay.
    #[inline(always)]
    pub(super) fn delete(&mut self, t: u32) {
        for word in t as usize..t as usize + 4 {
            self.words.set(word, self.words.get(word) | DELETED);
        }
    }

    /// Undoes [`Complex::delete`], if nothing was written since.
    pub(super) fn restore(&mut self, t: u32) {
        for word in t as usize..t as usize + 4 {
            self.words.set(word, self.words.get(word) & !DELETED);
        }
    }

    /// Whether a tetrahedron is deleted.
    #[inline(always)]
    pub(super) fn is_deleted(&self, t: u32) -> bool {
        self.opposite(t) >= DELETED
    }

    /// Whether a tetrahedron is frozen.
    #[inline(always)]
    pub(super) fn is_frozen(&self, t: u32) -> bool {
        self.opposite(t) & FROZEN != 0
    }

    /// Whether there is room for so many tetrahedra.
    #[inline(always)]
    pub(super) fn has_room(&self, count: usize) -> bool {
        count <= self.free.len() + self.fresh.len()
    }

    /// The place of a tetrahedron yet to be written: one that was deleted, or a new one, for which there must
    /// be room.
    #[inline(always)]
    pub(super) fn allocate(&mut self) -> u32 {
        self.free.pop().unwrap_or_else(|| (self.fresh.next().expect("room was asked for") * WORDS) as u32)
    }

    /// Writes a tetrahedron.
    #[inline(always)]
    pub(super) fn write(&mut self, t: u32, vertices: [u32; 4], neighbours: [Facet; 4]) {
        self.words.write(t, vertices, neighbours);
    }

    /// The facet of tetrahedron `t` on the hull, if `t` is infinite.
    #[inline(always)]
    pub(super) fn hull_facet(&self, t: u32) -> Option<Facet> {
        let infinite = self.infinite();
        let [a, b, c, d] = self.corners(t);
        let side = if a == infinite {
            0
        } else if b == infinite {
            1
        } else if c == infinite {
            2
        } else if d == infinite {
            3
        } else {
            return None;
        };
        Some(t + side)
    }
}

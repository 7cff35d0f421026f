//! The cavity of a new point: the tetrahedra in conflict with it, and the facets around them.

use super::complex::{Complex, Facet, VERTEX, tetrahedron_of};
use super::insphere3::{Frame, Signs};
use super::lanes::Lanes;
use super::tetrahedralization::Vertex;
use super::weights::Weights;
use crate::simplex::TETRAHEDRON_FACETS;

/// A facet of the cavity or of its border, in two words: they take fewer instructions to write than four.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Face {
    /// The number of its first corner, and above it that of the second.
    first: u64,
    /// The number of its third corner, and above it the facet of the tetrahedron beyond.
    last: u64,
}

impl Face {
    /// A facet with corners of these numbers, counterclockwise as the new point sees them, and the facet of
    /// the tetrahedron beyond.
    #[inline(always)]
    pub(super) fn new([a, b, c]: [u32; 3], beyond: Facet) -> Face {
        Face { first: u64::from(a) | u64::from(b) << 32, last: u64::from(c) | u64::from(beyond) << 32 }
    }

    #[inline(always)]
    pub(super) fn corners(self) -> [u32; 3] {
        [self.first as u32, (self.first >> 32) as u32, self.last as u32]
    }

    #[inline(always)]
    pub(super) fn beyond(self) -> Facet {
        (self.last >> 32) as u32
    }
}

/// A facet, and whether the tetrahedron beyond is in conflict with the new point, if that is known.
pub(super) type Finding = (Face, Option<bool>);

impl Signs {
    /// The finding about one of the tetrahedra.
    pub(super) fn of(self, i: usize) -> Option<bool> {
        match (self.inside >> i & 1, self.outside >> i & 1) {
            (1, _) => Some(true),
            (_, 1) => Some(false),
            _ => None,
        }
    }
}

/// No vertex.
pub(super) const NO_VERTEX: u32 = u32::MAX;

/// Tetrahedra of a cavity that the buffers hold at first.
const ROOM: usize = 64;

/// How many more entries than that the lists have: what one tetrahedron may add, and then some.
const SPARE: usize = 8;

/// The known part of a cavity and of its border. The next insertion reuses the buffers.
///
/// The lists are longer than what is in them. What is behind is of an earlier insertion: numbers of vertices
/// that are in the lists, and facets of tetrahedra that are in the part of the complex.
#[derive(Debug)]
pub(super) struct Cavity {
    /// Facets through which its tetrahedra were found, and how many there are; that of the first one is any.
    pub(super) entered: Vec<Face>,
    pub(super) found: usize,
    /// Of how many tetrahedra the neighbours have been tested.
    pub(super) tested: usize,
    /// The facets around them.
    pub(super) border: Vec<Face>,
    pub(super) border_len: usize,
    /// The vertices by number, with [`NO_VERTEX`] behind the last one, and how many there are.
    pub(super) vertices: Vec<u32>,
    pub(super) count: usize,
    /// Their coordinates relative to the new point, and their lifts.
    pub(super) rows: Vec<[f64; 4]>,
    /// How many tetrahedra there may be before the buffers have to grow.
    pub(super) room: usize,
}

impl Default for Cavity {
    fn default() -> Cavity {
        let mut cavity = Cavity {
            entered: Vec::new(),
            found: 0,
            tested: 0,
            border: Vec::new(),
            border_len: 0,
            vertices: Vec::new(),
            count: 0,
            rows: Vec::new(),
            room: 0,
        };
        cavity.make_room(ROOM);
        cavity
    }
}

impl Cavity {
    /// Makes the buffers long enough for so many tetrahedra. The first has four vertices and four neighbours;
    /// each other one adds at most one vertex, and two facets of the border.
    fn make_room(&mut self, room: usize) {
        self.room = room;
        // The first facet is of the complex, or of none yet.
        let any = self.entered.first().copied().unwrap_or_default();
        self.entered.resize(room + SPARE, any);
        self.border.resize(2 * room + 2 * SPARE, Face::default());
        self.vertices.resize(room + 2 * SPARE, NO_VERTEX);
        self.rows.resize(room + 2 * SPARE, [0.0; 4]);
    }

    #[cold]
    #[inline(never)]
    pub(super) fn grow(&mut self) {
        self.make_room(2 * self.room);
    }

    /// Forgets facets of an earlier complex. In their place is a tetrahedron of this one, and of this part:
    /// the search reads its words, which others must not write.
    pub(super) fn clear(&mut self, t: u32) {
        self.entered.fill(Face::new([0; 3], t));
        self.border.fill(Face::default());
    }

    /// The facets around the cavity.
    #[inline(always)]
    pub(super) fn border(&self) -> &[Face] {
        &self.border[..self.border_len]
    }

    /// The facets through which its tetrahedra were found.
    #[inline(always)]
    pub(super) fn entered(&self) -> &[Face] {
        &self.entered[..self.found]
    }

    #[inline(always)]
    pub(super) fn vertices(&self) -> &[u32] {
        &self.vertices[..self.count]
    }

    /// Begins with tetrahedron `t`, which is in conflict; returns its neighbours.
    #[inline(always)]
    pub(super) fn open<L: Lanes, W: Weights>(
        &mut self,
        t: u32,
        complex: &mut Complex<'_>,
        frame: &Frame<'_, L, W>,
    ) -> [Finding; 4] {
        let (vertices, neighbours) = (complex.corners(t), complex.neighbours(t));
        for (number, vertex) in vertices.into_iter().enumerate() {
            let place = complex.place_of_number(vertex);
            complex.numbers[place] = number as u32;
            self.rows[number] = frame.row(vertex, &complex.vertices[vertex as usize]);
        }
        self.vertices[..4].copy_from_slice(&vertices);
        self.vertices[4] = NO_VERTEX;
        self.entered[0] = Face::new([0; 3], t);
        (self.count, self.found, self.tested, self.border_len) = (4, 1, 1, 0);
        complex.delete(t);
        let mut apexes = [0; 4];
        for side in 0..4 {
            apexes[side] = complex.opposite(neighbours[side]) & VERTEX;
        }
        // Corner 0 is d for three facets, corner 1 for the fourth.
        let vertices = complex.vertices;
        let [r, s, t, u] = [&self.rows[0], &self.rows[1], &self.rows[2], &self.rows[3]];
        let near = signs(frame, [s, u, t, r], [apexes[1], apexes[3], apexes[2]], vertices);
        let far = signs(frame, [r, t, u, s], [apexes[0]; 3], vertices);
        let mut findings = [(Face::default(), None); 4];
        for side in 0..4 {
            let [a, b, c] = TETRAHEDRON_FACETS[side];
            let known = if side == 0 { far.of(0) } else { near.of([0, 0, 2, 1][side]) };
            findings[side] = (Face::new([a as u32, b as u32, c as u32], neighbours[side]), known);
        }
        findings
    }

    /// Adds the tetrahedron beyond a facet to the cavity, or the facet to its border.
    #[inline(always)]
    pub(super) fn add(&mut self, face: Face, is_in_conflict: bool, complex: &mut Complex<'_>) {
        if is_in_conflict {
            complex.delete(tetrahedron_of(face.beyond()));
            self.entered[self.found] = face;
            self.found += 1;
        } else {
            self.border[self.border_len] = face;
            self.border_len += 1;
        }
    }
}

/// The tests beyond facets of a tetrahedron with the given rows, where the given vertices are.
#[inline(always)]
fn signs<L: Lanes, W: Weights>(
    frame: &Frame<'_, L, W>,
    [a, b, c, d]: [&[f64; 4]; 4],
    apexes: [u32; 3],
    vertices: &[Vertex],
) -> Signs {
    let [u, v, w] = apexes;
    let places = [&vertices[u as usize], &vertices[v as usize], &vertices[w as usize]];
    frame.signs([a, b, c], d, frame.columns(apexes, places))
}

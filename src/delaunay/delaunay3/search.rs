//! The search of a cavity, from its first tetrahedron on.
//!
//! The search has no branch that depends on the geometry, because a processor could not predict it. A
//! tetrahedron joins the cavity, and is marked, as soon as it is found in conflict; so it is found once. Then
//! the three tetrahedra beyond its other facets are tested together. Each of these facets is written behind
//! two lists, the cavity's and the border's, and the result of the test moves the end of one of them: of none
//! if the tetrahedron beyond is in the cavity already.
//!
//! The tests of a tetrahedron are begun before the results for the tetrahedron before it are used, so that
//! the processor has something to do while it waits for them.

use super::cavity::{Cavity, Face, Finding, NO_VERTEX};
use super::complex::{
    Complex, DELETED, FIRST_NEIGHBOUR, FROZEN, Facet, VERTEX, facets_behind, tetrahedron_of,
};
use super::insphere3::{Frame, Signs};
use super::lanes::Lanes;
use super::tetrahedralization::Vertex;
use super::weights::Weights;
use super::words::{Trusted, Words};
use std::ops::Range;

/// Why a search stopped.
#[derive(Debug, Clone, Copy)]
pub(super) enum Stop {
    /// The cavity is complete.
    Complete,
    /// The buffers are full.
    Full,
    /// The neighbours of a tetrahedron: the filter does not know all of them, or there are frozen ones.
    Unsure([Option<Finding>; 3]),
}

/// The facets of a tetrahedron, but for the one through which it was found, and what is beyond.
#[derive(Debug, Clone, Copy, Default)]
struct Neighbours {
    faces: [Face; 3],
    signs: Signs,
}

/// A search under way: a view of the complex and the cavity. The counters are those of the [`Cavity`].
struct Search<'a, 's> {
    words: &'a mut Words<'s>,
    points: Trusted<&'a [Vertex]>,
    /// See [`Complex::numbers`].
    numbers: Trusted<&'a mut [u32]>,
    own: Range<u32>,
    entered: Trusted<&'a mut [Face]>,
    border: Trusted<&'a mut [Face]>,
    vertices: Trusted<&'a mut [u32]>,
    rows: Trusted<&'a mut [[f64; 4]]>,
    found: usize,
    border_len: usize,
    count: usize,
}

/// Searches until the cavity is complete or something stops it.
#[inline(always)]
pub(super) fn search<L: Lanes, W: Weights>(
    cavity: &mut Cavity,
    complex: &mut Complex<'_>,
    frame: &Frame<'_, L, W>,
) -> Stop {
    // SAFETY: corners of tetrahedra are vertices, with flags, and those of tetrahedra of a cavity are of the
    // part or at infinity. The numbers of vertices in facets are below `count`, and `room`, which is compared
    // with `found` before a tetrahedron adds its neighbours, leaves room for all lists: see `Cavity`.
    let mut search = unsafe {
        Search {
            words: &mut complex.words,
            points: Trusted::new(complex.vertices),
            numbers: Trusted::new(&mut complex.numbers),
            own: complex.own.clone(),
            entered: Trusted::new(&mut cavity.entered),
            border: Trusted::new(&mut cavity.border),
            vertices: Trusted::new(&mut cavity.vertices),
            rows: Trusted::new(&mut cavity.rows),
            found: cavity.found,
            border_len: cavity.border_len,
            count: cavity.count,
        }
    };
    let (stop, tested) = search.run(cavity.tested, cavity.room, frame);
    (cavity.found, cavity.border_len, cavity.count) = (search.found, search.border_len, search.count);
    cavity.tested = tested;
    stop
}

impl Search<'_, '_> {
    /// Returns of how many tetrahedra the neighbours have been tested, too.
    #[inline(always)]
    fn run<L: Lanes, W: Weights>(
        &mut self,
        mut tested: usize,
        room: usize,
        frame: &Frame<'_, L, W>,
    ) -> (Stop, usize) {
        // The neighbours of tetrahedron `tested - 1` wait in the place of that parity.
        let mut waiting = [Neighbours::default(); 2];
        let mut is_waiting = false;
        loop {
            let has_next = tested < self.found;
            if has_next {
                if self.found > room {
                    return (Stop::Full, tested - usize::from(is_waiting));
                }
                waiting[tested % 2] = self.test(tested, frame);
            } else if !is_waiting {
                return (Stop::Complete, tested);
            }
            if is_waiting && let Err(unsure) = self.sort(&waiting[(tested + 1) % 2]) {
                return (Stop::Unsure(unsure), tested);
            }
            tested += usize::from(has_next);
            is_waiting = has_next;
        }
    }

    /// Tests the neighbours of a tetrahedron of the cavity.
    #[inline(always)]
    fn test<L: Lanes, W: Weights>(&mut self, number: usize, frame: &Frame<'_, L, W>) -> Neighbours {
        let (face, later) = (self.entered[number], self.entered[number + 1].beyond());
        self.prefetch_neighbours(later);
        let ([a, b, c], beyond) = (face.corners(), face.beyond());
        let apex = self.words.get(beyond as usize) & !DELETED;
        let neighbours = self.behind(beyond, self.vertices[a as usize] | DELETED);
        let d = self.number(apex, frame);
        let rows = [&self.rows[a as usize], &self.rows[b as usize], &self.rows[c as usize]];
        let [i, j, k] = neighbours;
        let (u, v, w) = (self.words.get(i as usize), self.words.get(j as usize), self.words.get(k as usize));
        let [u, v, w] = [u & VERTEX, v & VERTEX, w & VERTEX];
        let places = [&self.points[u as usize], &self.points[v as usize], &self.points[w as usize]];
        let signs = frame.signs(rows, &self.rows[d as usize], frame.columns([u, v, w], places));
        let faces = [Face::new([d, b, c], i), Face::new([a, d, c], j), Face::new([a, b, d], k)];
        Neighbours { faces, signs }
    }

    /// The neighbours of the next tetrahedron will be needed. (A facet behind the end of the list is one of
    /// an earlier insertion.)
    #[inline(always)]
    fn prefetch_neighbours(&self, facet: Facet) {
        let first = tetrahedron_of(facet) as usize + FIRST_NEIGHBOUR;
        for side in 0..4 {
            self.words.prefetch(self.words.get(first + side) as usize);
        }
    }

    /// [`facets_behind`] a facet of a marked tetrahedron.
    #[inline(always)]
    fn behind(&self, facet: Facet, a: u32) -> [Facet; 3] {
        let t = tetrahedron_of(facet) as usize;
        let [i, j, k] = facets_behind(self.words.four(t), facet, a);
        let neighbours = t + FIRST_NEIGHBOUR;
        [self.words.get(neighbours + i), self.words.get(neighbours + j), self.words.get(neighbours + k)]
    }

    /// The number of a vertex of the cavity: the next one if it has none yet.
    #[inline(always)]
    fn number<L: Lanes, W: Weights>(&mut self, vertex: u32, frame: &Frame<'_, L, W>) -> u32 {
        let next = self.count;
        let place = vertex.wrapping_sub(self.own.start).min(self.own.end - self.own.start) as usize;
        let known = (self.numbers[place] as usize).min(next);
        let is_known = self.vertices[known] == vertex;
        let number = if is_known { known } else { next };
        self.numbers[place] = number as u32;
        self.rows[number] = frame.row(vertex, &self.points[vertex as usize]);
        self.vertices[next] = vertex;
        self.count = next + usize::from(!is_known);
        self.vertices[self.count] = NO_VERTEX;
        number as u32
    }

    /// Adds what is beyond the facets to the cavity, or the facets to its border.
    #[inline(always)]
    fn sort(&mut self, neighbours: &Neighbours) -> Result<(), [Option<Finding>; 3]> {
        let Neighbours { faces, signs } = neighbours;
        let facets = [faces[0].beyond(), faces[1].beyond(), faces[2].beyond()];
        // Those that are not in the cavity.
        let [u, v, w] = facets;
        let (u, v, w) = (self.words.get(u as usize), self.words.get(v as usize), self.words.get(w as usize));
        let new = !u >> 31 | !v >> 31 << 1 | !w >> 31 << 2;
        let (inside, outside) = (signs.inside & new, signs.outside & new);
        if inside | outside != new || (u | v | w) & FROZEN != 0 {
            return Err([0, 1, 2].map(|i| (new >> i & 1 == 1).then(|| (faces[i], signs.of(i)))));
        }
        for i in 0..3 {
            self.entered[self.found] = faces[i];
            self.border[self.border_len] = faces[i];
            self.found += (inside >> i & 1) as usize;
            self.border_len += (outside >> i & 1) as usize;
            let t = tetrahedron_of(facets[i]) as usize;
            for corner in 0..4 {
                self.words.set(t + corner, self.words.get(t + corner) | inside >> i << 31);
            }
        }
        Ok(())
    }
}

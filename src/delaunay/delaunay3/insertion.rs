//! Insertion of points: the tetrahedra in conflict with a point give way to a star around it (Bowyer, 1981;
//! Watson, 1981).

use super::cavity::{Cavity, Face, Finding};
use super::complex::{Complex, VERTEX, tetrahedron_of};
use super::exact::{EXACT, Exact, is_inside};
use super::insphere3::Frame;
use super::lanes::Lanes;
use super::locate::{Site, is_in_conflict, walk, walk_exactly};
use super::search::{Stop, search};
use super::star::Star;
use super::stats::{PhaseTimer, Stats};
use super::translated::{InSphere, TranslatedVertex};
use super::weights::Weights;

/// Why a point was not inserted. Nothing has changed then.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Refusal {
    /// The walk to it came to a frozen tetrahedron.
    Blocked,
    /// A frozen tetrahedron is in conflict with it, or may be; where to start the walk to a point nearby.
    Frozen(u32),
    /// There is no room for its tetrahedra.
    Full,
}

/// What stops the search of a cavity before it begins.
enum Unopened {
    /// The tetrahedron that contains the point hides it.
    Hidden(u32),
    /// The walk came to a frozen tetrahedron.
    Blocked,
}

/// A frozen tetrahedron is in conflict, or may be.
struct FrozenConflict;

/// Buffers of one insertion, which the next one reuses.
#[derive(Debug, Default)]
pub(super) struct Buffers {
    cavity: Cavity,
    star: Star,
}

impl Buffers {
    /// Forgets tetrahedra of an earlier complex, for one of this complex that is not frozen.
    pub(super) fn clear(&mut self, t: u32) {
        self.cavity.clear(t);
    }
}

/// The tetrahedralization of the points inserted so far, and what inserting needs.
pub(super) struct Insertion<'a, 's, L: Lanes, W> {
    pub(super) complex: &'a mut Complex<'s>,
    pub(super) weights: &'a W,
    pub(super) predicates: &'a mut dyn Exact,
    pub(super) buffers: &'a mut Buffers,
    pub(super) stats: &'a mut Stats,
    pub(super) timer: PhaseTimer,
    /// The lift of the vertex at infinity: of about the size of others, for the sake of the filter; integer
    /// if coordinates are.
    pub(super) infinite_lift: f64,
    /// In-sphere tests of cavities so far.
    pub(super) tests: u64,
    /// Those that the filter did not decide.
    pub(super) unfiltered: u64,
    /// Proves that the processor has the instructions of the vectors.
    pub(super) token: L::Token,
}

impl<L: Lanes, W: Weights> Insertion<'_, '_, L, W> {
    /// Adds the decisions made here to the counts of the predicates.
    pub(super) fn finish(self) {
        self.predicates.counts_mut().filter += self.tests - self.unfiltered;
        self.stats.insphere_tests += self.tests;
    }

    /// Inserts vertex `q`, which is not in the mesh yet, unless others hide it; returns where to start the
    /// walk to a point nearby.
    #[inline(always)]
    pub(super) fn insert(&mut self, q: u32, start: u32) -> Result<u32, Refusal> {
        let at = Site { at: self.complex.point(q), weight: self.weights.of(q) };
        let found = self.find_conflict(at, start);
        self.timer.end_phase(&mut self.stats.locate);
        match found {
            Ok(t) => {
                if self.search_cavity(at, t).is_err() {
                    return Err(Refusal::Frozen(self.undo()));
                }
            }
            Err(Unopened::Hidden(t)) => return Ok(t),
            Err(Unopened::Blocked) => return Err(Refusal::Blocked),
        }
        self.timer.end_phase(&mut self.stats.cavity);
        let Buffers { cavity, star } = &mut *self.buffers;
        let (border, found) = (cavity.border().len(), cavity.entered().len());
        if !self.complex.has_room(border.saturating_sub(found)) {
            self.undo();
            return Err(Refusal::Full);
        }
        self.tests += (border + found) as u64 - 1;
        self.stats.created += border as u64;
        let start = star.write(self.complex, cavity, q);
        self.timer.end_phase(&mut self.stats.update);
        Ok(start)
    }

    /// Restores the tetrahedra of the cavity; returns the first of them.
    #[cold]
    #[inline(never)]
    fn undo(&mut self) -> u32 {
        let found = self.buffers.cavity.entered();
        self.tests += (self.buffers.cavity.border().len() + found.len()) as u64;
        found.iter().for_each(|face| self.complex.restore(tetrahedron_of(face.beyond())));
        tetrahedron_of(found[0].beyond())
    }

    /// Searches the cavity from a tetrahedron in conflict.
    #[inline(always)]
    fn search_cavity(&mut self, at: Site, t: u32) -> Result<(), FrozenConflict> {
        let infinite = self.complex.infinite();
        let (weights, infinite_lift, token) = (self.weights, self.infinite_lift, self.token);
        let frame = Frame::<L, W> { origin: at, weights, infinite, infinite_lift, token };
        for (face, known) in self.buffers.cavity.open(t, self.complex, &frame) {
            if let Some(is_in_conflict) = known
                && !self.complex.is_frozen(tetrahedron_of(face.beyond()))
            {
                self.buffers.cavity.add(face, is_in_conflict, self.complex);
            } else {
                self.settle(at, (face, known))?;
            }
        }
        loop {
            match search(&mut self.buffers.cavity, self.complex, &frame) {
                Stop::Complete => return Ok(()),
                Stop::Full => self.buffers.cavity.grow(),
                Stop::Unsure(findings) => {
                    for finding in findings.into_iter().flatten() {
                        self.settle(at, finding)?;
                    }
                }
            }
        }
    }

    /// Adds the tetrahedron beyond a facet to the cavity, or the facet to its border, where the filter does
    /// not know, or the tetrahedron is frozen.
    ///
    /// # Errors
    /// If it is frozen and in conflict. An infinite one counts as in conflict: that may depend on a
    /// tetrahedron of another part.
    #[cold]
    #[inline(never)]
    fn settle(&mut self, at: Site, (face, known): Finding) -> Result<(), FrozenConflict> {
        let t = tetrahedron_of(face.beyond());
        let is_frozen = self.complex.is_frozen(t);
        if is_frozen && self.complex.corners_of_any(t).contains(&self.complex.infinite()) {
            return Err(FrozenConflict);
        }
        let is_in_conflict = known.unwrap_or_else(|| self.decide(at, face));
        if is_frozen && is_in_conflict {
            return Err(FrozenConflict);
        }
        self.buffers.cavity.add(face, is_in_conflict, self.complex);
        Ok(())
    }

    #[inline(always)]
    fn translate(&self, vertex: u32, from: Site) -> TranslatedVertex {
        TranslatedVertex::new(self.complex, self.weights, vertex, from, self.infinite_lift)
    }

    /// Whether the tetrahedron beyond a facet is in conflict, if the filter did not tell.
    fn decide(&mut self, at: Site, face: Face) -> bool {
        let apex = self.complex.opposite(face.beyond()) & VERTEX;
        let vertices = face.corners().map(|number| self.buffers.cavity.vertices()[number as usize]);
        let [a, b, c] = vertices.map(|v| self.translate(v, at));
        let test = InSphere::new::<W>([self.translate(apex, at), a, c, b]);
        if test.is_certain::<W>() {
            return test.value > 0.0;
        }
        self.unfiltered += 1;
        if self.predicates.is_integer() && self.weights.are_integers() && test.greatest < EXACT {
            let infinite = self.complex.infinite();
            let is_finite = !vertices.contains(&infinite) && apex != infinite;
            let counts = self.predicates.counts_mut();
            if test.value != 0.0 {
                counts.integer += 1;
                return test.value > 0.0;
            }
            if is_finite {
                counts.integer += 1;
                counts.perturbed += 1;
                return is_inside(&test);
            }
        }
        is_in_conflict(self.complex, self.weights, tetrahedron_of(face.beyond()), at, self.predicates)
    }

    /// A tetrahedron in conflict with a point.
    #[inline(always)]
    fn find_conflict(&mut self, at: Site, start: u32) -> Result<u32, Unopened> {
        let t = walk(self.complex, start, at.at);
        if self.complex.is_frozen(t) {
            return Err(Unopened::Blocked);
        }
        let [a, b, c, d] = self.complex.corners(t);
        let (a, b) = (self.translate(a, at), self.translate(b, at));
        let (c, d) = (self.translate(c, at), self.translate(d, at));
        let test = InSphere::new::<W>([a, b, c, d]);
        if test.value > 0.0 && test.is_certain::<W>() {
            return Ok(t);
        }
        if !W::ARE_EQUAL && test.value < 0.0 && test.is_certain::<W>() && test.has_origin_inside() {
            return Err(Unopened::Hidden(t));
        }
        let t = walk_exactly(self.complex, self.weights, t, at, self.predicates);
        if self.complex.is_frozen(t) {
            return Err(Unopened::Blocked);
        }
        if !W::ARE_EQUAL && !is_in_conflict(self.complex, self.weights, t, at, self.predicates) {
            return Err(Unopened::Hidden(t));
        }
        Ok(t)
    }
}

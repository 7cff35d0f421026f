//! Insertion of points: the tetrahedra in conflict with a point give way to a star around it (Bowyer, 1981;
//! Watson, 1981).

use super::complex::{Complex, DELETED, Facet, tetrahedron_of};
use super::exact::Exact;
use super::lanes::Lanes;
use super::locate::{Site, is_in_conflict, walk, walk_exactly};
use super::star::Star;
use super::stats::{PhaseTimer, Stats};
use super::tetrahedralization::Vertex;
use super::tie::{EXACT, is_inside};
use super::translated::{InSphere, TranslatedVertex};
use super::weights::Weights;
use crate::predicates::{INSPHERE_SQUARED_BOUND, POWER_SQUARED_BOUND, TINY};
use bytemuck::cast;
use spmesh_model::simplex::TETRAHEDRON_FACETS;

/// A facet around the part of the cavity that is known, with the test of the tetrahedron beyond.
#[derive(Debug, Clone, Copy)]
struct Pending {
    /// Positive if the new point is in the sphere of that tetrahedron, negative if it is not; NaN if rounding
    /// may have changed the sign.
    value: f64,
    /// Numbers of the corners in the star, counterclockwise as the new point sees them.
    corners: [u32; 3],
    neighbour: Facet,
    /// The vertex opposite to `beyond`.
    apex: u32,
}

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

/// Buffers of one insertion, which the next one reuses.
#[derive(Debug, Default)]
pub(super) struct Cavity {
    star: Star,
    /// A queue, written without branches: longer than what is in it.
    pending: Vec<Pending>,
    end: usize,
    /// For each vertex of the star, by number: its coordinates relative to the new point, and its lift.
    translated: Vec<[f64; 4]>,
}

impl Cavity {
    /// Forgets tetrahedra of an earlier complex.
    pub(super) fn clear(&mut self) {
        self.pending.iter_mut().for_each(|facet| facet.neighbour = 0);
    }
}

/// The tetrahedralization of the points inserted so far, and what inserting needs.
pub(super) struct Insertion<'a, 's, L: Lanes, W> {
    pub(super) complex: Complex<'s>,
    pub(super) weights: &'a W,
    pub(super) predicates: &'a mut dyn Exact,
    pub(super) cavity: &'a mut Cavity,
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

impl<'s, L: Lanes, W: Weights> Insertion<'_, 's, L, W> {
    /// The complex. Adds the decisions made here to the counts of the predicates.
    pub(super) fn finish(self) -> Complex<'s> {
        self.predicates.counts_mut().filter += self.tests - self.unfiltered;
        self.stats.insphere_tests += self.tests;
        self.complex
    }

    /// Inserts vertex `q`, which is not in the mesh yet, unless others hide it; returns where to start the
    /// walk to a point nearby.
    ///
    /// # Errors
    /// If a frozen tetrahedron would have to go, or if there is no room.
    ///
    /// The test of a tetrahedron is computed when its facet is queued, and used when the facet is taken from
    /// the queue, so that no test waits for the branch before it.
    #[inline(always)]
    pub(super) fn insert(&mut self, q: u32, start: u32) -> Result<u32, Refusal> {
        let at = Site { at: self.complex.point(q), weight: self.weights.of(q) };
        match self.open_cavity(at, start) {
            Err(Unopened::Hidden(t)) => return Ok(t),
            Err(Unopened::Blocked) => return Err(Refusal::Blocked),
            Ok(()) => {}
        }
        let mut next = 0;
        while next < self.cavity.end {
            let facet = self.cavity.pending[next];
            next += 1;
            // If it is taken, its neighbours are needed. (Entries behind the end are of an earlier
            // insertion.)
            let later = &self.cavity.pending[(next + 1).min(self.cavity.pending.len() - 1)];
            self.complex.fetch_neighbours(later.neighbour);
            if facet.value < 0.0 {
                self.cavity.star.border.push((facet.corners, facet.neighbour));
            } else if self.complex.opposite(facet.neighbour) >= DELETED {
                // Another facet has led to it in the meantime.
            } else if facet.neighbour < self.complex.frozen {
                if self.may_be_in_conflict(at, &facet) {
                    self.tests += next as u64;
                    return Err(Refusal::Frozen(self.undo()));
                }
                self.cavity.star.border.push((facet.corners, facet.neighbour));
            } else if facet.value > 0.0 || self.decide(at, &facet) {
                self.take(at, &facet);
            } else {
                self.cavity.star.border.push((facet.corners, facet.neighbour));
            }
        }
        self.timer.end_phase(&mut self.stats.cavity);
        self.tests += next as u64;
        if !self.complex.has_room(self.cavity.star.growth()) {
            self.undo();
            return Err(Refusal::Full);
        }
        self.stats.created += self.cavity.star.border.len() as u64;
        let start = self.cavity.star.close(&mut self.complex, q);
        self.timer.end_phase(&mut self.stats.update);
        Ok(start)
    }

    /// Restores the tetrahedra of the cavity; returns the first of them.
    #[cold]
    #[inline(never)]
    fn undo(&mut self) -> u32 {
        self.cavity.star.slots.iter().for_each(|&t| self.complex.restore(t));
        self.cavity.star.slots[0]
    }

    /// Whether the frozen tetrahedron beyond a facet may be in conflict. That of an infinite one may depend
    /// on a tetrahedron that is not here.
    #[cold]
    #[inline(never)]
    fn may_be_in_conflict(&mut self, at: Site, facet: &Pending) -> bool {
        let infinite = self.complex.infinite();
        self.complex.corners(tetrahedron_of(facet.neighbour)).contains(&infinite)
            || facet.value > 0.0
            || self.decide(at, facet)
    }

    /// Makes a tetrahedron in conflict the whole cavity.
    #[inline(always)]
    fn open_cavity(&mut self, at: Site, start: u32) -> Result<(), Unopened> {
        let found = self.find_conflict(at, start);
        self.timer.end_phase(&mut self.stats.locate);
        let (t, translated) = found?;
        // So that differences to it vanish.
        let infinite = self.complex.infinite();
        self.complex.vertices[infinite as usize].at = at.at;
        let corners = self.complex.corners(t);
        self.cavity.star.open(t, corners, &mut self.complex.vertices);
        self.cavity.end = 0;
        self.reserve();
        let rows = translated.map(|TranslatedVertex { at: [x, y, z], lift }| [x, y, z, lift]);
        self.cavity.translated[..4].copy_from_slice(&rows);
        let neighbours: [Facet; 4] = std::array::from_fn(|side| self.complex.neighbour(t + side as u32));
        self.complex.delete(t);
        let apexes = neighbours.map(|facet| self.complex.opposite(facet));
        let [d, a, c, b] = rows;
        let [va, vb, vc, _] = self.values(at, [a, b, c], d, [apexes[1], apexes[3], apexes[2]]).array();
        for (side, value) in [f64::NAN, va, vc, vb].into_iter().enumerate() {
            let corners = TETRAHEDRON_FACETS[side].map(|i| i as u32);
            self.cavity.pending[side] =
                Pending { value, corners, neighbour: neighbours[side], apex: apexes[side] };
        }
        self.cavity.end = 4;
        Ok(())
    }

    /// Adds the tetrahedron beyond a facet to the cavity.
    #[inline(always)]
    fn take(&mut self, at: Site, facet: &Pending) {
        let [a, b, c] = facet.corners;
        let neighbours = self.complex.neighbours_behind(facet.neighbour, self.cavity.star.vertex(a));
        let apexes = neighbours.map(|facet| self.complex.opposite(facet));
        let t = tetrahedron_of(facet.neighbour);
        self.complex.delete(t);
        self.cavity.star.slots.push(t);
        let d = self.cavity.star.number(facet.apex, &mut self.complex.vertices);
        let TranslatedVertex { at: [x, y, z], lift } = self.translate(facet.apex, at);
        let row = [x, y, z, lift];
        self.reserve();
        self.cavity.translated[d as usize] = row;
        let rows = facet.corners.map(|number| self.cavity.translated[number as usize]);
        let values = self.values(at, rows, row, apexes).array();
        let corners = [[d, b, c], [a, d, c], [a, b, d]];
        let places = &mut self.cavity.pending[self.cavity.end..][..3];
        let mut len = 0;
        for i in 0..3 {
            // The entry of a tetrahedron that is in the cavity already is overwritten, without a branch.
            places[len.min(2)] =
                Pending { value: values[i], corners: corners[i], neighbour: neighbours[i], apex: apexes[i] };
            len += usize::from(apexes[i] < DELETED);
        }
        self.cavity.end += len;
    }

    /// Makes the buffers long enough for one more tetrahedron in the cavity.
    #[inline(always)]
    fn reserve(&mut self) {
        let Cavity { star, pending, end, translated } = &mut *self.cavity;
        if translated.len() < star.capacity() || pending.len() < *end + 4 {
            let blank = Pending { value: 0.0, corners: [0; 3], neighbour: 0, apex: 0 };
            translated.resize(star.capacity(), [0.0; 4]);
            pending.resize(2 * *end + 64, blank);
        }
    }

    #[inline(always)]
    fn translate(&self, vertex: u32, from: Site) -> TranslatedVertex {
        TranslatedVertex::new(&self.complex, self.weights, vertex, from, self.infinite_lift)
    }

    /// The in-sphere tests of the three tetrahedra beyond the facets dbc, adc, abd of a tetrahedron, in this
    /// order, given the vertices opposite to the facets.
    ///
    /// In the lane of a facet without p, which is a, b or c, let n and m be the next two corners. With the
    /// new point as origin, the determinant of the rows (x, lift) of d, n, m and the apex e has the sign
    /// wanted. Its minors are made of n x m, and of d x p in the lanes of the other two facets. The vertex at
    /// infinity has the row (0, 0, 0, lift), which makes it the sign of a volume. The bound of the filter
    /// holds all the more.
    #[inline(always)]
    fn values(&self, at: Site, abc: [[f64; 4]; 3], d: [f64; 4], apexes: [u32; 3]) -> L {
        let [a, b, c] = abc;
        let [px, py, pz, lift] =
            L::columns([L::new(self.token, a), L::new(self.token, b), L::new(self.token, c)]);
        let p = [px, py, pz];
        let (d, d_lift) = (
            [L::splat(self.token, d[0]), L::splat(self.token, d[1]), L::splat(self.token, d[2])],
            L::splat(self.token, d[3]),
        );
        let [ex, ey, ez, e_lift] = self.apexes(at, apexes);
        let e = [ex, ey, ez];
        let nm = next(cross(p, next(p)));
        let dp = cross(d, p);
        let (n_lift, m_lift) = (lift.next(), lift.previous());
        let plus = m_lift.times_plus(dot(e, next(dp)), d_lift * dot(e, nm));
        let value = plus - n_lift.times_plus(dot(e, previous(dp)), e_lift * dot(d, nm));
        let greatest = n_lift.greater(m_lift).greater(d_lift.greater(e_lift));
        // Squares are greater than lifts by the spread of weights at most, and lifts are above its negative.
        let greatest = if W::ARE_EQUAL {
            greatest
        } else {
            greatest + L::splat(self.token, 2.0 * self.weights.spread())
        };
        let square = greatest * greatest;
        let fifth = square * square * greatest;
        let bound = if W::ARE_EQUAL { INSPHERE_SQUARED_BOUND } else { POWER_SQUARED_BOUND };
        let bound = fifth.times_plus(L::splat(self.token, bound), L::splat(self.token, TINY));
        value.where_greater(value * value, bound)
    }

    /// The translations of three vertices, column by column; arbitrary values for vertices of deleted
    /// tetrahedra.
    #[inline(always)]
    fn apexes(&self, from: Site, apexes: [u32; 3]) -> [L; 4] {
        let (infinite, at) = (self.complex.infinite(), from.at);
        let places = apexes.map(|apex| apex.min(infinite));
        let [u, v, w] = places.map(|place| cast::<Vertex, [f64; 4]>(self.complex.vertices[place as usize]));
        let [x, y, z, _] = L::columns([L::new(self.token, u), L::new(self.token, v), L::new(self.token, w)]);
        let (x, y, z) = (
            x - L::splat(self.token, at[0]),
            y - L::splat(self.token, at[1]),
            z - L::splat(self.token, at[2]),
        );
        let mut lift = dot([x, y, z], [x, y, z]);
        if !W::ARE_EQUAL {
            let [k, l, m] = places.map(|place| self.weights.of(place));
            lift = lift - (L::new(self.token, [k, l, m, 0.0]) - L::splat(self.token, from.weight));
        }
        if apexes.contains(&infinite) {
            let mut lifts = lift.array();
            for (lift, apex) in lifts.iter_mut().zip(apexes) {
                *lift = if apex == infinite { self.infinite_lift } else { *lift };
            }
            lift = L::new(self.token, lifts);
        }
        [x, y, z, lift]
    }

    /// Whether the tetrahedron beyond a facet is in conflict, if the filter did not tell.
    #[inline(never)]
    fn decide(&mut self, at: Site, facet: &Pending) -> bool {
        let vertices = facet.corners.map(|number| self.cavity.star.vertex(number));
        let [a, b, c] = vertices.map(|v| self.translate(v, at));
        let test = InSphere::new::<W>([self.translate(facet.apex, at), a, c, b]);
        if test.is_certain::<W>() {
            return test.value > 0.0;
        }
        self.unfiltered += 1;
        if self.predicates.is_integer() && self.weights.are_integers() && test.greatest < EXACT {
            let infinite = self.complex.infinite();
            let is_finite = !vertices.contains(&infinite) && facet.apex != infinite;
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
        is_in_conflict(&self.complex, self.weights, tetrahedron_of(facet.neighbour), at, self.predicates)
    }

    /// A tetrahedron in conflict with a point, and its corners relative to the point.
    #[inline(always)]
    fn find_conflict(&mut self, at: Site, start: u32) -> Result<(u32, [TranslatedVertex; 4]), Unopened> {
        let t = walk(&self.complex, start, at.at);
        if t < self.complex.frozen {
            return Err(Unopened::Blocked);
        }
        let test = InSphere::new::<W>(self.complex.corners(t).map(|v| self.translate(v, at)));
        if test.value > 0.0 && test.is_certain::<W>() {
            return Ok((t, test.corners));
        }
        if !W::ARE_EQUAL && test.value < 0.0 && test.is_certain::<W>() && test.has_origin_inside() {
            return Err(Unopened::Hidden(t));
        }
        let t = walk_exactly(&self.complex, self.weights, t, at, self.predicates);
        if t < self.complex.frozen {
            return Err(Unopened::Blocked);
        }
        if !W::ARE_EQUAL && !is_in_conflict(&self.complex, self.weights, t, at, self.predicates) {
            return Err(Unopened::Hidden(t));
        }
        Ok((t, self.complex.corners(t).map(|v| self.translate(v, at))))
    }
}

// Closures and `map` would not be inlined into functions for one kind of processor.

#[inline(always)]
fn cross<L: Lanes>(p: [L; 3], q: [L; 3]) -> [L; 3] {
    [
        p[1].times_minus(q[2], p[2] * q[1]),
        p[2].times_minus(q[0], p[0] * q[2]),
        p[0].times_minus(q[1], p[1] * q[0]),
    ]
}

#[inline(always)]
fn dot<L: Lanes>(p: [L; 3], q: [L; 3]) -> L {
    p[0].times_plus(q[0], p[1].times_plus(q[1], p[2] * q[2]))
}

#[inline(always)]
fn next<L: Lanes>(p: [L; 3]) -> [L; 3] {
    [p[0].next(), p[1].next(), p[2].next()]
}

#[inline(always)]
fn previous<L: Lanes>(p: [L; 3]) -> [L; 3] {
    [p[0].previous(), p[1].previous(), p[2].previous()]
}

//! Insertion of points: the triangles in conflict with a point give way to a star around it (Bowyer, 1981;
//! Watson, 1981).

use super::half_edge::{HalfEdge, next, previous, triangle_of, triangles_of};
use super::locate::{Start, cross, difference, is_in_conflict, walk, walk_exactly};
use super::mesh::Mesh;
use crate::predicates::{INCIRCLE_BOUND, Numbers, Point2, PredicateCounts, Predicates2};

/// With lifts k, l, m of three points around the new one, the rounded in-circle determinant has the sign of
/// the exact one if its magnitude is more than this times k l + l m + m k.
///
/// The bound of the filter ([`crate::predicates`]) is [`INCIRCLE_BOUND`] times the sum of magnitudes, of
/// which each term is a lift times the magnitudes of the two products of a cross product, which are together
/// at most the product of two distances, so at most half the sum of two lifts. The margin is for the rounding
/// of the bound.
const ERROR: f64 = INCIRCLE_BOUND * (1.0 + 1e-6);

/// If the bound of integers is below this, their sum of magnitudes is below 2^53, and so is every
/// intermediate: nothing was rounded.
const ROUNDED: f64 = ERROR * 9_007_199_254_740_992.0;

/// A vertex in coordinates relative to the new point.
#[derive(Debug, Clone, Copy)]
struct TranslatedVertex {
    vertex: u32,
    /// Difference to the new point.
    at: Point2,
    /// Square of the distance.
    lift: f64,
}

impl TranslatedVertex {
    #[inline(always)]
    fn new(mesh: &Mesh, vertex: u32, from: Point2) -> TranslatedVertex {
        let at = difference(mesh.point(vertex), from);
        TranslatedVertex { vertex, at, lift: at[0] * at[0] + at[1] * at[1] }
    }
}

/// An edge of the border of the known part of the cavity. Its outer triangle is yet to be tested for
/// conflict.
#[derive(Debug, Clone, Copy)]
struct Pending {
    neighbour: HalfEdge,
    /// The end of the edge, counterclockwise.
    end: TranslatedVertex,
    /// Cross product of the ends of the edge.
    cross: f64,
}

/// The triangulation of the points inserted so far, and what inserting needs.
pub(super) struct Insertion<'s, 'a, P> {
    mesh: Mesh<'s>,
    predicates: &'a mut P,
    cavity: &'a mut Cavity,
    /// In-circle tests, and those among them that the filter did not decide.
    tests: u64,
    unfiltered: u64,
}

/// Buffers of one insertion, which the next one reuses.
#[derive(Debug, Default)]
pub(super) struct Cavity {
    pending: Vec<Pending>,
    /// Triangles to be written: the two that are new, then those in conflict, as they are found.
    slots: Vec<HalfEdge>,
}

impl<'s, 'a, P: Predicates2> Insertion<'s, 'a, P> {
    /// Begins with the corners of the four triangles of `mesh`.
    pub(super) fn new(mesh: Mesh<'s>, predicates: &'a mut P, cavity: &'a mut Cavity) -> Self {
        Insertion { mesh, predicates, cavity, tests: 0, unfiltered: 0 }
    }

    /// The triangulation. Adds the decisions made here to the counts of the predicates.
    pub(super) fn finish(self) -> Mesh<'s> {
        self.predicates.counts_mut().filter += self.tests - self.unfiltered;
        self.mesh
    }

    /// Inserts vertex `q`, which is not in the mesh yet; returns where to start the walk to a point at
    /// `then`.
    ///
    /// The cavity is passed counterclockwise, depth first: its triangles form a tree, since no vertex lies
    /// inside, so that none is met twice and no marks are needed. Each edge of its border makes a triangle
    /// with `q`.
    #[inline(always)]
    pub(super) fn insert(&mut self, q: u32, start: Start, then: Point2) -> Start {
        let at = self.mesh.point(q);
        let (mut from, mut edge) = self.open_cavity(q, start, at);
        let mut star = Star::new(q, from, difference(then, at));
        loop {
            let apex = TranslatedVertex::new(&self.mesh, self.mesh.opposite(edge.neighbour), at);
            let left = cross(from.at, apex.at);
            let right = cross(apex.at, edge.end.at);
            if self.is_in_circle(at, (from, left), apex, (&edge, right)) {
                let Cavity { pending, slots } = &mut *self.cavity;
                slots.push(triangle_of(edge.neighbour));
                pending.push(Pending {
                    neighbour: self.mesh.neighbour(previous(edge.neighbour)),
                    cross: right,
                    ..edge
                });
                edge =
                    Pending { neighbour: self.mesh.neighbour(next(edge.neighbour)), end: apex, cross: left };
                continue;
            }
            star.add(&mut self.mesh, self.cavity.slots[star.len], from, &edge);
            from = edge.end;
            match self.cavity.pending.pop() {
                Some(before) => edge = before,
                None => break,
            }
        }
        // Each edge of the border failed a test, and each triangle of the cavity but the first passed one.
        self.tests += 2 * self.cavity.slots.len() as u64 - 3;
        star.close(&mut self.mesh)
    }

    /// Makes a triangle in conflict the whole cavity: the start of one of its edges, and that edge. The
    /// others wait.
    #[inline(always)]
    fn open_cavity(&mut self, q: u32, start: Start, at: Point2) -> (TranslatedVertex, Pending) {
        let (t, [a, b, c], [bc, ca, ab]) = self.find_conflict(start, at);
        let [first, second] = triangles_of(q);
        let neighbours = [t, t + 1, t + 2].map(|h| self.mesh.neighbour(h));
        let Cavity { pending, slots } = &mut *self.cavity;
        slots.clear();
        slots.extend([first, second, t]);
        pending.clear();
        pending.extend([
            Pending { neighbour: neighbours[1], end: a, cross: ca },
            Pending { neighbour: neighbours[0], end: c, cross: bc },
        ]);
        (a, Pending { neighbour: neighbours[2], end: b, cross: ab })
    }

    /// Whether the new point, at `at`, is in the circle of the triangle beyond an edge, which has the vertex
    /// `apex` opposite to it; with the cross products of the start of the edge and the apex, and of the apex
    /// and its end.
    #[inline(always)]
    fn is_in_circle(
        &mut self,
        at: Point2,
        (from, left): (TranslatedVertex, f64),
        apex: TranslatedVertex,
        (edge, right): (&Pending, f64),
    ) -> bool {
        let end = edge.end;
        let value = end.lift * left + from.lift * right - apex.lift * edge.cross;
        let error = ERROR * (apex.lift * (from.lift + end.lift) + from.lift * end.lift);
        if P::NUMBERS != Numbers::FiniteFloats && value.abs() > error {
            return value > 0.0;
        }
        self.unfiltered += 1;
        if P::NUMBERS == Numbers::Integers && error < ROUNDED {
            settle(value, apex.at, (from.at, left), (end.at, right), self.predicates.counts_mut())
        } else {
            is_in_conflict(&self.mesh, triangle_of(edge.neighbour), at, self.predicates)
        }
    }

    /// A triangle in conflict with a point, its corners relative to the point, and for each corner the cross
    /// product of the ends of the opposite side.
    #[inline(always)]
    fn find_conflict(&mut self, start: Start, at: Point2) -> (HalfEdge, [TranslatedVertex; 3], [f64; 3]) {
        if P::NUMBERS != Numbers::FiniteFloats {
            let t = walk(&self.mesh, start, at);
            let (t, corners, crosses) = look(&self.mesh, t, at);
            let [k, l, m] = corners.map(|corner| corner.lift);
            let value = k * crosses[0] + l * crosses[1] + m * crosses[2];
            if value > ERROR * (k * (l + m) + l * m) {
                return (t, corners, crosses);
            }
        }
        let t = walk_exactly(&self.mesh, start.triangle, at, self.predicates);
        look(&self.mesh, t, at)
    }
}

/// A triangle, its corners relative to `at`, and for each corner the cross product of the ends of the
/// opposite side.
#[inline(always)]
fn look(mesh: &Mesh, t: HalfEdge, at: Point2) -> (HalfEdge, [TranslatedVertex; 3], [f64; 3]) {
    let corners = mesh.vertices(t).map(|v| TranslatedVertex::new(mesh, v, at));
    let side = |i: usize, j: usize| cross(corners[i].at, corners[j].at);
    (t, corners, [side(1, 2), side(2, 0), side(0, 1)])
}

/// The triangles around the new point, as they are written counterclockwise.
struct Star {
    /// The new point.
    q: u32,
    /// The next point, seen from the new one.
    then: Point2,
    is_left_of_then: bool,
    first: HalfEdge,
    last: HalfEdge,
    len: usize,
    /// Where the walk to the next point starts.
    start: Start,
}

impl Star {
    /// No triangle yet; the first edge will begin at `from`.
    #[inline(always)]
    fn new(q: u32, from: TranslatedVertex, then: Point2) -> Star {
        let [first, _] = triangles_of(q);
        let start = Start { triangle: first, is_seen: false };
        Star { q, then, is_left_of_then: cross(from.at, then) >= 0.0, first, last: first, len: 0, start }
    }

    /// Writes the triangle of an edge to `slot`, and links it to the one before.
    #[inline(always)]
    fn add(&mut self, mesh: &mut Mesh, slot: HalfEdge, from: TranslatedVertex, edge: &Pending) {
        mesh.write(slot, [self.q, from.vertex, edge.end.vertex], [edge.neighbour, slot, self.last + 1]);
        mesh.set_neighbour(edge.neighbour, slot);
        mesh.set_neighbour(self.last + 1, slot + 2);
        let end_is_left = cross(edge.end.at, self.then) >= 0.0;
        // Which of the triangles it is cannot be predicted: no branch.
        let is_towards = self.is_left_of_then & !end_is_left;
        self.start = Start {
            triangle: std::hint::select_unpredictable(is_towards, slot, self.start.triangle),
            is_seen: self.start.is_seen | is_towards,
        };
        self.is_left_of_then = end_is_left;
        self.last = slot;
        self.len += 1;
    }

    /// Links the last triangle to the first.
    #[inline(always)]
    fn close(self, mesh: &mut Mesh) -> Start {
        mesh.set_neighbour(self.last + 1, self.first + 2);
        mesh.set_neighbour(self.first + 2, self.last + 1);
        self.start
    }
}

/// Decides by a value that was not rounded, ties by the canonical perturbation: whether the new point, the
/// origin, is in the circle of w, b, a. The point of greatest rank decides; orientations about the origin are
/// at hand.
///
/// If w is of greatest rank, the origin is outside, because it sees the edge from a to b counterclockwise: a
/// point on that edge or beyond it, but in the circle of the triangle on this side, is strictly inside of the
/// circle of the one on the other, which is no tie; and edges further out face the same way.
#[inline(always)]
fn settle(
    value: f64,
    w: Point2,
    (a, aw): (Point2, f64),
    (b, wb): (Point2, f64),
    counts: &mut PredicateCounts,
) -> bool {
    counts.integer += 1;
    if value != 0.0 {
        return value > 0.0;
    }
    counts.perturbed += 1;
    // None of this can be predicted: no branches.
    let is_above = |p: Point2, q: Point2| (p[0] > q[0]) | ((p[0] == q[0]) & (p[1] > q[1]));
    let origin = [0.0; 2];
    let with_a = is_above(a, w) & is_above(a, origin) & (wb > 0.0);
    let with_b = is_above(b, w) & is_above(b, origin) & (aw > 0.0);
    let a_is_above = is_above(a, b);
    (a_is_above & with_a) | (!a_is_above & with_b)
}

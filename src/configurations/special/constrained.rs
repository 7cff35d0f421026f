//! Constrained Delaunay triangulation, by flips: given segments become edges.
//!
//! Edges that cross a segment are flipped until none crosses it (Sloan, "A fast algorithm for generating
//! constrained Delaunay triangulations", Computers & Structures 47, 1993). Then new edges are flipped until
//! they are constrained Delaunay.

use std::collections::VecDeque;

use crate::knots::Knots;
use crate::plane::Plane;
use crate::surface::{Around, Corner, Start};
use foldhash::{HashSet, HashSetExt};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_delaunay::delaunay2::distinct;
use spmesh_delaunay::predicates::{FiniteFloatPredicates, Sign};
use spmesh_stream::model::configurations::FARAWAY;

/// A triangulation with fixed edges, which are never flipped.
pub(super) struct Constrained<'a> {
    start: Start,
    plane: Plane<'a, FiniteFloatPredicates>,
    /// A corner at each knot.
    corner_at: Vec<Corner>,
    /// Fixed edges, with the lesser end first.
    fixed: HashSet<[u32; 2]>,
}

/// The first part of a segment: the next knot on it, and the edges that it crosses before that knot, each
/// with its right end first.
struct Passage {
    to: u32,
    crossed: Vec<[u32; 2]>,
}

impl<'a> Constrained<'a> {
    pub(super) fn new(knots: &'a Knots, start: Start, predicates: &'a mut FiniteFloatPredicates) -> Self {
        let plane = Plane::new(knots, None, predicates);
        let mut all = Constrained { start, plane, corner_at: vec![0; knots.len()], fixed: HashSet::new() };
        (0..all.start.triangles.len() as u32).for_each(|triangle| all.note(triangle));
        all
    }

    /// The triangulation, without a claim to be Delaunay.
    pub(super) fn into_start(self) -> Start {
        self.start.generalised()
    }

    /// Makes the segment between two knots a fixed edge, or several edges if other knots lie on it. Returns
    /// the knots on the way from `a` to `b`, both included.
    ///
    /// Cost: quadratic in the number of edges that the segment crosses, which is small for typical segments.
    pub(super) fn fix(&mut self, a: u32, b: u32) -> Result<Vec<u32>> {
        let mut path = vec![a];
        let mut from = a;
        while from != b {
            let Some(Passage { to, crossed }) = self.passage(from, b) else {
                return Err(stuck([a, b]));
            };
            if let Some(&[c, d]) = crossed.iter().find(|&&edge| self.is_fixed(edge)) {
                return Err(self.crossing([a, b], [c, d]));
            }
            let fresh = self.clear([from, to], crossed)?;
            self.fixed.insert([from.min(to), from.max(to)]);
            self.restore(fresh);
            path.push(to);
            from = to;
        }
        Ok(path)
    }

    /// The error for a segment that crosses a fixed edge. An edge without length means that the segment
    /// passes through a knot. Of coinciding knots the error names the first: others may be copies that the
    /// user did not give.
    #[cold]
    fn crossing(&self, ends: [u32; 2], edge: [u32; 2]) -> Error {
        let firsts = distinct(self.plane.knots.points());
        let [c, d] = edge.map(|id| firsts[id as usize]);
        let (c, d) = (c.min(d), c.max(d));
        if c == d {
            return through(ends, c);
        }
        let what = format!("it crosses the one from knot {c} to knot {d}");
        Error::usage(format!("{what}: add a knot where they cross, or leave one out")).at(segment(ends))
    }

    /// Whether an edge is fixed.
    pub(super) fn is_fixed(&self, [a, b]: [u32; 2]) -> bool {
        self.fixed.contains(&[a.min(b), a.max(b)])
    }

    /// The third knot of the triangle to the left of an edge; `None` if there is no such edge, or only an
    /// infinite triangle to the left.
    pub(super) fn apex(&self, a: u32, b: u32) -> Option<u32> {
        let corner = self.corner(a, b)? as usize;
        let apex = self.start.triangles[corner / 3][corner % 3];
        (apex != FARAWAY).then_some(apex)
    }

    /// Inserts a knot that is not a vertex yet on an edge, or near it; the halves of the edge are fixed.
    /// Returns the two knots opposite to the edge, left and right.
    pub(super) fn split(&mut self, [a, b]: [u32; 2], middle: u32) -> Result<[u32; 2]> {
        let corner = self.corner(a, b).ok_or_else(|| stuck([a, b]))?;
        let Some([v, _, w, _]) = self.start.quadrilateral(corner) else {
            let what = "it is on the border of the knots: a crease there needs knots on both sides";
            return Err(Error::usage(what).at(segment([a, b])));
        };
        for [p, q, r] in [[v, a, middle], [w, b, middle], [v, middle, b], [w, middle, a]] {
            if !self.plane.is_left(p, q, r) {
                let what = "its triangles are too flat for a knot between its ends";
                return Err(Error::usage(what).at(segment([a, b])));
            }
        }
        self.start.split(corner, middle);
        // Update corners from one new triangle first, then from all triangles around the new vertex.
        self.note(self.start.triangles.len() as u32 - 1);
        let around: Vec<u32> = self.start.star(self.corner_at[middle as usize]).map(|c| c / 3).collect();
        around.into_iter().for_each(|triangle| self.note(triangle));
        self.fixed.remove(&[a.min(b), a.max(b)]);
        self.fixed.extend([a, b].map(|end| [end.min(middle), end.max(middle)]));
        Ok([v, w])
    }

    /// Updates the corners at the vertices of a triangle.
    fn note(&mut self, triangle: u32) {
        for (place, v) in (0..).zip(self.start.triangles[triangle as usize]) {
            if let Some(corner) = self.corner_at.get_mut(v as usize) {
                *corner = 3 * triangle + place;
            }
        }
    }

    /// The corner opposite to the edge from `a` to `b`, to the left of it.
    fn corner(&self, a: u32, b: u32) -> Option<Corner> {
        let after = |corner: Corner, steps: u32| corner - corner % 3 + (corner % 3 + steps) % 3;
        let vertex = |corner: Corner| self.start.triangles[corner as usize / 3][corner as usize % 3];
        let mut around = self.start.star(self.corner_at[a as usize]);
        around.find(|&at| vertex(after(at, 1)) == b).map(|at| after(at, 2))
    }

    /// The part of the segment from `a` to `b` up to the next knot.
    fn passage(&mut self, a: u32, b: u32) -> Option<Passage> {
        let around: Vec<Corner> = self.start.star(self.corner_at[a as usize]).collect();
        for corner in around {
            let (t, i) = (corner as usize / 3, corner as usize % 3);
            let [p, q] = [1, 2].map(|step| self.start.triangles[t][(i + step) % 3]);
            if p == FARAWAY || q == FARAWAY {
                continue;
            }
            for end in [p, q] {
                if end == b || self.is_ahead(a, b, end) {
                    return Some(Passage { to: end, crossed: Vec::new() });
                }
            }
            if self.plane.orient(a, b, p) == Sign::Negative && self.plane.is_left(a, b, q) {
                return self.walk([a, b], corner, [p, q]);
            }
        }
        None
    }

    /// Whether a knot is on the ray from `a` through `b`.
    fn is_ahead(&mut self, a: u32, b: u32, v: u32) -> bool {
        self.plane.orient(a, b, v) == Sign::Zero && !self.plane.is_between(v, b, a)
    }

    /// Walks along the segment from the triangle of `corner` across the edge from `p` to `q`, and on to the
    /// next knot.
    fn walk(&mut self, [a, b]: [u32; 2], corner: Corner, [mut p, mut q]: [u32; 2]) -> Option<Passage> {
        let mut crossed = Vec::new();
        let mut corner = corner;
        for _ in 0..self.start.triangles.len() {
            crossed.push([p, q]);
            let neighbour = self.start.neighbours[corner as usize / 3][corner as usize % 3];
            let triangle = self.start.triangles[neighbour as usize / 3];
            let v = triangle[neighbour as usize % 3];
            if v == FARAWAY {
                return None;
            }
            let side = if v == b { Sign::Zero } else { self.plane.orient(a, b, v) };
            let left_behind = match side {
                Sign::Zero => return Some(Passage { to: v, crossed }),
                Sign::Positive => std::mem::replace(&mut q, v),
                Sign::Negative => std::mem::replace(&mut p, v),
            };
            let place = (0..).zip(triangle).find(|&(_, other)| other == left_behind)?.0;
            corner = neighbour - neighbour % 3 + place;
        }
        None
    }

    /// Flips edges until none crosses the segment; returns the new edges.
    fn clear(&mut self, [a, b]: [u32; 2], crossed: Vec<[u32; 2]>) -> Result<Vec<[u32; 2]>> {
        let mut fresh = Vec::new();
        let count = crossed.len();
        // Each round of the queue flips at least one edge, and each pair of crossing edges arises at most
        // once.
        let mut left = count.saturating_mul(count).saturating_mul(count).saturating_add(8);
        let mut waiting: VecDeque<[u32; 2]> = crossed.into();
        while let Some([p, q]) = waiting.pop_front() {
            left -= 1;
            let Some(corner) = self.corner(p, q).filter(|_| left > 0) else { return Err(stuck([a, b])) };
            if !self.start.can_flip(&mut self.plane, corner) {
                waiting.push_back([p, q]);
                continue;
            }
            let [v, w] = self.flip(corner);
            let is_apart = ![v, w].iter().any(|end| [a, b].contains(end));
            if is_apart && self.plane.orient(a, b, v) != self.plane.orient(a, b, w) {
                waiting.push_back([v, w]);
            } else {
                fresh.push([v, w]);
            }
        }
        Ok(fresh)
    }

    /// Flips the given edges and edges around them until all edges that are not fixed are Delaunay.
    fn restore(&mut self, mut waiting: Vec<[u32; 2]>) {
        while let Some([p, q]) = waiting.pop() {
            let Some(corner) = self.corner(p, q).filter(|_| !self.is_fixed([p, q])) else { continue };
            let Some([v, a, w, b]) = self.start.quadrilateral(corner) else { continue };
            if self.plane.is_inside([v, a, b], w) && self.start.can_flip(&mut self.plane, corner) {
                self.flip(corner);
                waiting.extend([[v, a], [a, w], [w, b], [b, v]]);
            }
        }
    }

    /// Flips an edge, and returns the ends of the new edge.
    fn flip(&mut self, corner: Corner) -> [u32; 2] {
        let neighbour = self.start.neighbours[corner as usize / 3][corner as usize % 3];
        self.start.flip(corner);
        [corner / 3, neighbour / 3].into_iter().for_each(|triangle| self.note(triangle));
        let [v, _, w] = self.start.triangles[corner as usize / 3];
        [v, w]
    }
}

impl Start {
    /// Inserts a vertex on the edge opposite to a corner: four triangles replace two.
    fn split(&mut self, corner: Corner, middle: u32) {
        let Around { triangles: [t, u], corners: [v, a, w, b], neighbours: [va, aw, wb, bv] } =
            self.around(corner);
        let (m, n) = (self.triangles.len() as u32, self.triangles.len() as u32 + 1);
        self.triangles[t as usize] = [v, a, middle];
        self.triangles[u as usize] = [w, b, middle];
        self.triangles.extend([[v, middle, b], [w, middle, a]]);
        self.neighbours.resize(self.triangles.len(), [0; 3]);
        let inner = [(3 * t, 3 * n), (3 * t + 1, 3 * m + 2), (3 * u, 3 * m), (3 * u + 1, 3 * n + 2)];
        let outer = [(3 * t + 2, va), (3 * u + 2, wb), (3 * m + 1, bv), (3 * n + 1, aw)];
        inner.into_iter().chain(outer).for_each(|(here, there)| self.set_neighbour(here, there));
    }
}

/// Names a segment in error messages.
pub(super) fn segment([a, b]: [u32; 2]) -> String {
    format!("segment from knot {a} to knot {b}")
}

/// The error for a segment with a knot on it.
#[cold]
pub(super) fn through(ends: [u32; 2], knot: u32) -> Error {
    Error::usage(format!("knot {knot} is on it: name it, too, between the two")).at(segment(ends))
}

#[cold]
fn stuck(ends: [u32; 2]) -> Error {
    Error::new(ErrorKind::Audit, "no way leads along it through the triangulation").at(segment(ends))
}

/// Required diagonals in the links of some knots; the rule triangulates the pieces between them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Diagonals {
    /// Each row is a knot and the ends of a diagonal in its link; sorted.
    rows: Vec<(u32, [u32; 2])>,
}

impl Diagonals {
    pub(super) fn new(mut rows: Vec<(u32, [u32; 2])>) -> Diagonals {
        rows.sort_unstable();
        Diagonals { rows }
    }

    /// Whether there are no diagonals.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The ends of the diagonals in the link of a set; there are some only for single knots.
    ///
    /// Cost: a binary search.
    pub fn of(&self, set: &[u32]) -> impl ExactSizeIterator<Item = [u32; 2]> + '_ {
        let rows = match *set {
            [knot] => {
                let start = self.rows.partition_point(|row| row.0 < knot);
                &self.rows[start..start + self.rows[start..].partition_point(|row| row.0 == knot)]
            }
            _ => &[],
        };
        rows.iter().map(|row| row.1)
    }
}

//! Knots: points with ids, several of which may coincide.
//!
//! # Repeated knots
//! Configurations are combinatorial: a repeated knot is two knots. To tell copies apart, the set of knots is
//! treated as the limit of sets P(e) for e > 0 tending to 0. In P(e), the knot of *rank* j is at
//! `p + e (j, j * j)`; its rank is the number of knots with lesser ids at the same place. For small e the
//! knots of P(e) are distinct, and every sign is the sign of the first nonzero coefficient of a polynomial in
//! e (`symbolic`). Knots of P(e) on one circle or line remain undecided, as in any set of distinct points.
//! The canonical perturbation of lifts decides these, by the lexicographic order of P(e). So the result is
//! that of an ordinary set of distinct points that then move together, and the theory applies unchanged.
//! Triangles of two copies and another knot are counterclockwise in P(e) and have no area at e = 0.
//!
//! Knots of which a linear map is P(e), such as those of a stretched copy of the plane, are displaced by the
//! same map of (j, j * j): then configurations of one are those of the other ([`Knots::displaced`]).
//!
//! Copies lie on a parabola, so no three are on a line. No four are on a circle, because their abscissae
//! would have to sum to zero.

use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay2::{MAX_POINTS, distinct};
use spmesh_delaunay::predicates::{FiniteFloatPredicates, Point2, Predicates2, Sign, lexicographic};
use std::cmp::Ordering;

/// Knots by id; knots at one place differ in rank.
#[derive(Debug, Clone, Default)]
pub struct Knots {
    points: Vec<Point2>,
    /// Ranks by id; empty if no two knots are at one place.
    ranks: Vec<u32>,
    displacement: Displacement,
}

/// How knots are displaced by their rank j: by a linear map of (j, j * j), given by its rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Displacement(pub [[i64; 2]; 2]);

impl Default for Displacement {
    fn default() -> Displacement {
        Displacement([[1, 0], [0, 1]])
    }
}

impl Displacement {
    /// The displacement of a knot of some rank, in units of e.
    pub(super) fn of(self, rank: i64) -> [i64; 2] {
        self.0.map(|[a, b]| a * rank + b * rank * rank)
    }

    /// Bits of the greatest factor by which displacements are greater than without a map, at most.
    pub(super) fn bits(self) -> i32 {
        if self == Displacement::default() {
            return 0;
        }
        let greatest = self.0.as_flattened().iter().map(|entry| entry.unsigned_abs()).max();
        65 - greatest.unwrap_or(0).leading_zeros() as i32
    }
}

impl Knots {
    /// Knots at `points`; ids are indices.
    ///
    /// Cost: a sort.
    ///
    /// # Errors
    /// A coordinate that is not finite; more than [`MAX_POINTS`] knots.
    pub fn new(points: Vec<Point2>) -> Result<Knots> {
        if points.len() > MAX_POINTS {
            let found = points.len();
            return Err(Error::usage(format!("{found} knots, at most {MAX_POINTS} can be handled")));
        }
        if let Some(bad) = points.iter().position(|p| !p.iter().all(|c| c.is_finite())) {
            let message = format!("coordinate is not finite: {:?}", points[bad]);
            return Err(Error::malformed(message).at(format!("knot {bad}")));
        }
        let representatives = distinct(&points);
        let is_copy = |(id, &first): (usize, &u32)| first != id as u32;
        let mut ranks = Vec::new();
        if representatives.iter().enumerate().any(is_copy) {
            let mut copies = vec![0; points.len()];
            for first in representatives {
                ranks.push(copies[first as usize]);
                copies[first as usize] += 1;
            }
        }
        Ok(Knots { points, ranks, displacement: Displacement::default() })
    }

    /// The same knots, displaced by another map. Its determinant must be positive, entries less than 2^56,
    /// and at most two knots at a place.
    #[must_use]
    pub fn displaced(self, displacement: Displacement) -> Knots {
        Knots { displacement, ..self }
    }

    /// How knots are displaced by their rank.
    pub(super) fn displacement(&self) -> Displacement {
        self.displacement
    }

    /// Whether all knots, at least one, are at the same place.
    #[inline]
    pub(super) fn are_copies(&self, ids: &[u32]) -> bool {
        self.has_copies() && ids.iter().all(|&id| self.at(id) == self.at(ids[0]))
    }

    /// Whether all knots, at least one, are on one line.
    pub fn are_collinear(&self, ids: &[u32]) -> bool {
        let first = self.at(ids[0]);
        let Some(second) = ids.iter().map(|&id| self.at(id)).find(|&other| other != first) else {
            return true;
        };
        let mut predicates = FiniteFloatPredicates::default();
        ids.iter().all(|&id| predicates.orient2d(first, second, self.at(id)) == Sign::Zero)
    }

    /// Positions by id.
    pub fn points(&self) -> &[Point2] {
        &self.points
    }

    /// Number of knots, copies included.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there is no knot.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Whether two knots are at one place.
    pub fn has_copies(&self) -> bool {
        !self.ranks.is_empty()
    }

    /// Number of knots of lesser id at the place of knot `id`.
    #[inline]
    pub fn rank(&self, id: u32) -> u32 {
        self.ranks.get(id as usize).copied().unwrap_or(0)
    }

    /// Position of knot `id`, which is not [`FARAWAY`](spmesh_stream::model::configurations::FARAWAY).
    #[inline(always)]
    pub fn at(&self, id: u32) -> Point2 {
        self.points[id as usize]
    }

    /// Lexicographic order of P(e), as polynomials in e: abscissa, its displacement, ordinate, its
    /// displacement.
    pub fn order(&self, a: u32, b: u32) -> Ordering {
        let (p, q) = (self.at(a), self.at(b));
        if !self.has_copies() {
            return lexicographic(p, q);
        }
        let [u, v] = [a, b].map(|id| self.displacement.of(i64::from(self.rank(id))));
        lexicographic([p[0]], [q[0]])
            .then(u[0].cmp(&v[0]))
            .then_with(|| lexicographic([p[1]], [q[1]]))
            .then(u[1].cmp(&v[1]))
    }

    /// The error for knots that are all on one line.
    pub(super) fn collinear() -> Error {
        Error::usage("the knots lie on one line: configurations need three that do not")
    }
}

//! The walk to a simplex in conflict with a point.

use super::coefficient::Coefficient;
use super::complex::{Complex, FACETS, Lifted, simplex_of, without};
use crate::diagram4::determinant::{difference, dot, normal};
use crate::diagram4::exact::orientation;

/// Steps after which the walk is assumed to be lost because of rounding: hundreds of times as many as usual.
const STEPS_MAX: usize = 1_000;

/// Relative difference below which two powers of a point count as equal.
const TIE: f64 = 1e-9;

impl<C: Coefficient> Complex<'_, C> {
    /// A simplex in conflict with vertex `q` at `p`.
    ///
    /// On the hyperplane of the facet between two simplices, a point has equal powers with respect to both
    /// spheres; on either side, the power is less for the simplex of that side. So the walk goes to the
    /// lesser power (thesis 3.6.4). Between equal spheres, the side of the hyperplane decides.
    #[inline(always)]
    pub(super) fn locate(&self, q: u32, p: &Lifted, start: usize) -> usize {
        let mut at = self.neighbour_inside(start).unwrap_or(start);
        for _ in 0..STEPS_MAX {
            if self.is_in_conflict(at, q, p) {
                return at;
            }
            match self.step(at, q, p) {
                Some(next) if self.neighbour_inside(next).is_some() => return next,
                Some(next) => at = next,
                None => break,
            }
        }
        self.walk_exactly(q, at)
    }

    /// The next simplex of the walk; an infinite one is in conflict.
    #[inline(always)]
    fn step(&self, at: usize, q: u32, p: &Lifted) -> Option<usize> {
        let (value, m) = (self.value(at, p), self.determinant(at).value());
        let neighbours = self.simplices[at].neighbours;
        let turn = q as usize % FACETS;
        (turn..turn + FACETS).map(|i| i % FACETS).find_map(|side| {
            let next = simplex_of(neighbours[side]);
            let next_m = self.determinant(next).value();
            let is_nearer = if next_m == 0.0 {
                self.is_in_conflict(next, q, p)
            } else {
                let (here, there) = (value * next_m, self.value(next, p) * m);
                if (there - here).abs() > TIE * (there.abs() + here.abs()) {
                    there < here
                } else {
                    self.is_beyond(at, side, p)
                }
            };
            is_nearer.then_some(next)
        })
    }

    /// Whether a point is beyond a facet of a finite simplex, in rounded arithmetic.
    #[inline(never)]
    fn is_beyond(&self, at: usize, side: usize, p: &Lifted) -> bool {
        let vertices = self.simplices[at].vertices;
        let near = |vertex: u32| self.near[vertex as usize];
        let [o, a, b, c] = without(vertices, side).map(near);
        let n = normal([a, b, c].map(|corner| difference(corner, &o)).each_ref());
        let [own, new] =
            [near(vertices[side]), [p[0], p[1], p[2], p[3]]].map(|x| dot(&n, &difference(x, &o)));
        (own > 0.0 && new < 0.0) || (own < 0.0 && new > 0.0)
    }

    /// Walks on to the simplex that contains vertex `q`, or to an infinite one that it can see: across any
    /// facet that has `q` strictly beyond. In a Delaunay triangulation, such a walk never cycles
    /// (Edelsbrunner, 1989).
    #[cold]
    fn walk_exactly(&self, q: u32, start: usize) -> usize {
        let mut at = start;
        while self.neighbour_inside(at).is_none() {
            let Some(side) = (0..FACETS).find(|&side| self.is_exactly_beyond(at, side, q)) else { break };
            at = simplex_of(self.simplices[at].neighbours[side]);
        }
        at
    }

    /// Whether `q` and the opposite vertex are strictly on two sides of a facet.
    fn is_exactly_beyond(&self, at: usize, side: usize, q: u32) -> bool {
        let vertices = self.simplices[at].vertices;
        let facet = without(vertices, side).map(|vertex| self.point(vertex));
        let side_of = |vertex: u32| orientation(self.sites.exactness, facet, self.point(vertex));
        let (own, new) = (side_of(vertices[side]), side_of(q));
        new.is_ne() && new == own.reverse()
    }
}

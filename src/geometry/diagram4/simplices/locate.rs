//! The walk to a simplex in conflict with a point.

use super::coefficient::Coefficient;
use super::complex::{Complex, FACETS, INFINITE, Lifted, simplex_of, without};
use crate::diagram4::determinant::{difference, dot, normal};

/// Steps after which rounding is taken to have led the walk in a circle.
const STEPS_MAX: usize = 100_000;

/// Powers of a point that differ by less, relatively, are taken to be equal.
const TIE: f64 = 1e-9;

impl<C: Coefficient> Complex<'_, C> {
    /// A simplex in conflict with vertex `q` at `p`.
    ///
    /// Where two spheres meet, the powers of a point with respect to them are equal on the hyperplane of the
    /// facet between, and less on the side of the own simplex: so the walk goes to the lesser power (thesis
    /// 3.6.4). Equal spheres say nothing, and the hyperplane has to be asked.
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
        self.search(q, p)
    }

    /// The next simplex of the walk; an infinite one is in conflict.
    #[inline(always)]
    fn step(&self, at: usize, q: u32, p: &Lifted) -> Option<usize> {
        let (value, m) = (self.value(at, p), self.determinant(at).value());
        let beyond = self.simplices[at].beyond;
        let turn = q as usize % FACETS;
        (turn..turn + FACETS).map(|i| i % FACETS).find_map(|side| {
            let next = simplex_of(beyond[side]);
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
        let n = normal([a, b, c].map(|corner| difference(corner, &o)));
        let [own, new] =
            [near(vertices[side]), [p[0], p[1], p[2], p[3]]].map(|x| dot(&n, &difference(x, &o)));
        (own > 0.0 && new < 0.0) || (own < 0.0 && new > 0.0)
    }

    /// Looks at all simplices.
    #[cold]
    fn search(&self, q: u32, p: &Lifted) -> usize {
        let is_wanted = |&simplex: &usize| !self.is_dead(simplex) && self.is_in_conflict(simplex, q, p);
        debug_assert!(!self.simplices.is_empty() && q != INFINITE);
        (0..self.simplices.len()).find(is_wanted).expect("each point is in a simplex or beyond the hull")
    }
}

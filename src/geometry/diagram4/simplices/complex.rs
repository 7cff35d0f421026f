//! The simplices of the triangulation, in flat arrays.

use super::coefficient::Coefficient;
use super::lanes::{LANES, Lanes};
use crate::diagram4::determinant::{difference, dot, lift, normal, sphere};
use crate::diagram4::exact::{in_sphere, orientation};
use crate::diagram4::sites::Sites;
use spmesh_core::prefetch::prefetch;
use spmesh_model::cells4::Point4;
use std::cmp::Ordering;

/// The faraway point (thesis 4.3), vertex of the infinite simplices, which lie beyond the hull.
pub(in crate::diagram4) const INFINITE: u32 = u32::MAX;

/// Facets, and vertices, of a simplex: facet i is opposite to vertex i.
pub(in crate::diagram4) const FACETS: usize = 5;

/// A facet of a simplex: the number of the simplex above three bits.
pub(in crate::diagram4) type Facet = u32;

#[inline(always)]
pub(in crate::diagram4) fn simplex_of(facet: Facet) -> usize {
    (facet >> 3) as usize
}

#[inline(always)]
pub(in crate::diagram4) fn facet_of(facet: Facet) -> usize {
    (facet & 7) as usize
}

#[inline(always)]
pub(in crate::diagram4) fn facet(simplex: usize, side: usize) -> Facet {
    (simplex as u32) << 3 | side as u32
}

/// Neighbour of a facet that has none yet: a facet of simplex 0, a dummy.
pub(super) const NO_NEIGHBOUR: Facet = 0;

/// Maximum number of simplices: facets are numbered in 31 bits.
pub(super) const SIMPLICES_MAX: usize = 1 << 28;

/// A positively oriented simplex: det(b - a, c - a, d - a, e - a) > 0. The faraway point stands for any point
/// beyond the facet of the hull.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::diagram4) struct Simplex {
    pub(in crate::diagram4) vertices: [u32; FACETS],
    /// For each facet, the same facet as seen from the neighbouring simplex.
    pub(in crate::diagram4) neighbours: [Facet; FACETS],
}

/// The vector (n, m, s) whose product with (x, |x|^2, 1) is negative inside a sphere, or beyond a hyperplane
/// of the hull. m is positive for a sphere, 0 for a hyperplane, and negative for a dead simplex.
pub(in crate::diagram4) type Sphere<C> = [C; 6];

/// Bound on the rounding errors of values, if coordinates differ by at most 1.
///
/// The sum of magnitudes of all terms that a value expands to is at most 480, and of each at most 47 factors
/// 1 + e,
/// |e| <= 2^-53, deviate: 480 * 47 < 2^15. Of hyperplanes it is less.
const ROUNDING: f64 = 1.0 / (1u64 << 38) as f64;

/// A point as the vector (x, |x|^2, 1) of in-sphere tests.
pub(super) type Lifted = [f64; 6];

pub(in crate::diagram4) struct Complex<'a, C> {
    pub(in crate::diagram4) sites: &'a Sites,
    /// The site of each vertex; vertices are numbered in order of insertion.
    pub(in crate::diagram4) order: Vec<u32>,
    pub(in crate::diagram4) near: Vec<Point4>,
    /// The first is a dummy: see [`NO_NEIGHBOUR`].
    pub(in crate::diagram4) simplices: Vec<Simplex>,
    pub(in crate::diagram4) spheres: Vec<Sphere<C>>,
    /// Numbers of dead simplices.
    pub(super) free: Vec<u32>,
    /// Values of greater magnitude have the correct sign.
    rounding: f64,
}

impl<'a, C: Coefficient> Complex<'a, C> {
    pub(super) fn new(sites: &'a Sites, order: Vec<u32>) -> Complex<'a, C> {
        let near = order.iter().map(|&number| sites.near(number)).collect();
        let rounding = if sites.exactness.is_double() { 0.0 } else { ROUNDING };
        let (simplices, spheres) = (vec![Simplex::default()], vec![[C::DEAD; 6]]);
        Complex { sites, order, near, simplices, spheres, free: Vec::new(), rounding }
    }

    /// The point of a vertex, as given.
    pub(super) fn point(&self, vertex: u32) -> Point4 {
        self.sites.points[self.order[vertex as usize] as usize]
    }

    pub(super) fn lifted(&self, vertex: u32) -> Lifted {
        let p = self.near[vertex as usize];
        [p[0], p[1], p[2], p[3], lift(&p), 1.0]
    }

    #[inline(always)]
    pub(in crate::diagram4) fn is_dead(&self, simplex: usize) -> bool {
        self.determinant(simplex) < C::default()
    }

    /// m of the sphere of a simplex.
    #[inline(always)]
    pub(super) fn determinant(&self, simplex: usize) -> C {
        self.spheres[simplex][4]
    }

    /// Prefetches the neighbours of a simplex.
    #[inline(always)]
    pub(super) fn fetch_neighbours(&self, simplex: usize) {
        for neighbour in self.simplices[simplex].neighbours {
            prefetch(&self.spheres, simplex_of(neighbour));
            prefetch(&self.simplices, simplex_of(neighbour));
        }
    }

    /// Whether the simplex is alive and finite.
    pub(in crate::diagram4) fn is_finite(&self, simplex: usize) -> bool {
        self.determinant(simplex) > C::default()
    }

    /// Whether the simplex is alive and infinite.
    pub(in crate::diagram4) fn is_infinite(&self, simplex: usize) -> bool {
        self.determinant(simplex) == C::default()
    }

    #[inline(always)]
    pub(super) fn value(&self, simplex: usize, p: &Lifted) -> f64 {
        let s = self.spheres[simplex].map(C::value);
        let even = s[0] * p[0] + s[2] * p[2] + s[4] * p[4];
        let odd = s[1] * p[1] + s[3] * p[3] + s[5] * p[5];
        even + odd
    }

    /// Whether vertex `q`, at `p`, is inside the sphere of a simplex.
    #[inline(always)]
    pub(super) fn is_in_conflict(&self, simplex: usize, q: u32, p: &Lifted) -> bool {
        let value = self.value(simplex, p);
        if self.is_clear(value, simplex) { value < 0.0 } else { self.decide(simplex, q, p) }
    }

    /// Whether the sign of a value is conclusive. Values of small integers are exact: zero means on the
    /// sphere.
    #[inline(always)]
    pub(super) fn is_clear(&self, value: f64, simplex: usize) -> bool {
        value.abs() > self.rounding || (self.rounding == 0.0 && !self.is_infinite(simplex))
    }

    /// Decides a conflict exactly. For an infinite simplex, the side of its hyperplane decides; for a point
    /// on that hyperplane, the sphere of the finite neighbour (thesis 4.4).
    #[inline(never)]
    pub(super) fn decide(&self, simplex: usize, q: u32, p: &Lifted) -> bool {
        match self.sign(simplex, q) {
            Ordering::Less => true,
            Ordering::Greater => false,
            Ordering::Equal => match self.neighbour_inside(simplex) {
                Some(inside) => self.is_dead(inside) || self.is_in_conflict(inside, q, p),
                None => false,
            },
        }
    }

    /// The finite simplex across the hull from an infinite one.
    pub(in crate::diagram4) fn neighbour_inside(&self, simplex: usize) -> Option<usize> {
        let Simplex { vertices, neighbours, .. } = &self.simplices[simplex];
        let side = vertices.iter().position(|&vertex| vertex == INFINITE)?;
        Some(simplex_of(neighbours[side]))
    }

    /// The sign of the value of a vertex.
    #[inline(always)]
    pub(in crate::diagram4) fn sign(&self, simplex: usize, q: u32) -> Ordering {
        let value = self.value(simplex, &self.lifted(q));
        if value > self.rounding {
            Ordering::Greater
        } else if value < -self.rounding {
            Ordering::Less
        } else if self.rounding == 0.0 {
            Ordering::Equal
        } else {
            self.exact_sign(simplex, q)
        }
    }

    #[inline(never)]
    fn exact_sign(&self, simplex: usize, q: u32) -> Ordering {
        let vertices = self.simplices[simplex].vertices;
        let point = self.point(q);
        let exactness = self.sites.exactness;
        match vertices.iter().position(|&vertex| vertex == INFINITE) {
            None => in_sphere(exactness, vertices.map(|vertex| self.point(vertex)), point),
            Some(side) => {
                let facet = without(vertices, side).map(|vertex| self.point(vertex));
                let sign = orientation(exactness, facet, point);
                if side % 2 == 0 { sign.reverse() } else { sign }
            }
        }
    }

    /// The spheres of simplices that all have a vertex at `o`, or hyperplanes of infinite ones; `sides` gives
    /// the place of that vertex in each.
    #[inline(always)]
    pub(super) fn spheres_of(
        &self,
        o: &Point4,
        simplices: [&[u32; FACETS]; LANES],
        sides: [usize; LANES],
    ) -> [Sphere<C>; LANES] {
        let facets = [
            without(*simplices[0], sides[0]),
            without(*simplices[1], sides[1]),
            without(*simplices[2], sides[2]),
            without(*simplices[3], sides[3]),
        ];
        let origin = o.map(|x| Lanes([x; LANES]));
        let corners = [0, 1, 2, 3].map(|i| difference(self.corners(facets.map(|facet| facet[i])), &origin));
        // Moving the common vertex to the front passes as many others as its place.
        let signs = Lanes(sides.map(|side| if side % 2 == 0 { 1.0 } else { -1.0 }));
        let (n, m) = sphere(corners);
        let s = m * lift(&origin) - dot(&n, &origin);
        let twice = m + m;
        let shifted = |axis: usize| signs * (n[axis] - twice * origin[axis]);
        let columns = [shifted(0), shifted(1), shifted(2), shifted(3), signs * m, signs * s];
        std::array::from_fn(|lane| {
            if facets[lane].contains(&INFINITE) {
                return self.hyperplane(simplices[lane]).map(C::of);
            }
            let [a, b, c, d, m, s] = columns.map(|column| column.0[lane]);
            [C::of(a), C::of(b), C::of(c), C::of(d), C::determinant(m), C::of(s)]
        })
    }

    /// The points of four vertices, axis by axis; an arbitrary point for the faraway point.
    #[inline(always)]
    fn corners(&self, vertices: [u32; LANES]) -> [Lanes; 4] {
        let last = self.near.len() - 1;
        let [a, b, c, d] = vertices.map(|vertex| &self.near[last.min(vertex as usize)]);
        [0, 1, 2, 3].map(|axis| Lanes([a[axis], b[axis], c[axis], d[axis]]))
    }

    #[inline(never)]
    fn hyperplane(&self, vertices: &[u32; FACETS]) -> [f64; 6] {
        let side = vertices.iter().position(|&vertex| vertex == INFINITE).unwrap_or_default();
        let [o, a, b, c] = without(*vertices, side).map(|vertex| self.near[vertex as usize]);
        let n = normal([a, b, c].map(|p| difference(p, &o)).each_ref());
        // Moving the faraway point to the end passes 4 - side others; values beyond the hull are negative.
        let n = if side % 2 == 0 { n.map(|x| -x) } else { n };
        [n[0], n[1], n[2], n[3], 0.0, -dot(&n, &o)]
    }
}

/// The vertices of a facet.
#[inline(always)]
pub(in crate::diagram4) fn without(vertices: [u32; FACETS], side: usize) -> [u32; 4] {
    std::array::from_fn(|i| vertices[i + usize::from(i >= side)])
}

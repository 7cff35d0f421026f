//! The simplices of the triangulation, in flat arrays, with room behind them, where a star is made.

use std::cmp::Ordering;
use std::marker::PhantomData;

use super::coefficient::Coefficient;
use super::lanes::{LANES, Lanes};
use crate::diagram4::determinant::{difference, dot, lift, lifted_sphere};
use crate::diagram4::exact::{in_sphere, orientation};
use crate::diagram4::sites::Sites;
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::prefetch::prefetch;
use spmesh_stream::model::cells4::Point4;

/// The faraway point (thesis 4.3), vertex of the infinite simplices, which lie beyond the hull. Points are
/// vertices from 1.
pub(in crate::diagram4) const INFINITE: u32 = 0;

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
pub(in crate::diagram4) const SIMPLICES_MAX: usize = 1 << 28;

/// A positively oriented simplex: det(b - a, c - a, d - a, e - a) > 0. The faraway point stands for any point
/// beyond the facet of the hull.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::diagram4) struct Simplex {
    /// In increasing order, but for the first two, whose order makes the simplex positive.
    pub(in crate::diagram4) vertices: [u32; FACETS],
    /// For each facet, the same facet as seen from the neighbouring simplex.
    pub(in crate::diagram4) neighbours: [Facet; FACETS],
}

/// The vector (n, m, s) whose product with (x, |x|^2, 1) is negative inside a sphere, or beyond a hyperplane
/// of the hull. m is positive for a sphere, 0 for a hyperplane, and negative for a dead simplex.
pub(in crate::diagram4) type Sphere<C> = [C; 6];

/// Bound on the rounding errors of values, if coordinates differ by at most 1.
///
/// The magnitudes of all terms that a value expands to sum to at most 480. Each term has at most 47 factors
/// 1 + e with |e| <= 2^-53, and 480 * 47 < 2^15. Hyperplanes have less.
const ROUNDING: f64 = 1.0 / (1u64 << 38) as f64;

/// A point as the vector (x, |x|^2, 1) of in-sphere tests.
pub(super) type Lifted = [f64; 6];

pub(in crate::diagram4) struct Complex<'a, C> {
    pub(in crate::diagram4) sites: &'a Sites,
    /// The site of each vertex; vertices are numbered in order of insertion, from 1.
    pub(in crate::diagram4) order: Vec<u32>,
    /// The point of each vertex; NaN for the faraway point.
    pub(in crate::diagram4) near: Vec<Point4>,
    /// The first is a dummy: see [`NO_NEIGHBOUR`].
    pub(in crate::diagram4) simplices: Vec<Simplex>,
    pub(in crate::diagram4) spheres: Vec<Sphere<C>>,
    /// Values of greater magnitude have the correct sign.
    pub(in crate::diagram4) rounding: f64,
    /// Most simplices.
    most: usize,
}

impl<'a, C: Coefficient> Complex<'a, C> {
    pub(super) fn new(sites: &'a Sites, mut order: Vec<u32>, most: usize) -> Complex<'a, C> {
        let faraway = std::iter::once([f64::NAN; 4]);
        let near = faraway.chain(order.iter().map(|&number| sites.near(number))).collect();
        order.insert(INFINITE as usize, u32::MAX);
        let rounding = if sites.exactness.is_double() { 0.0 } else { ROUNDING };
        let (simplices, spheres) = (vec![Simplex::default()], vec![[C::DEAD; 6]]);
        Complex { sites, order, near, simplices, spheres, rounding, most }
    }

    /// Takes places for new simplices: free ones first, then those behind all others, which are reserved but
    /// not part of the arrays until [`Complex::extend`]. Returns the length of the arrays with them.
    #[inline(always)]
    pub(super) fn allocate(
        &mut self,
        wanted: usize,
        free: &mut Vec<u32>,
        places: &mut Vec<u32>,
    ) -> Result<usize> {
        let (reused, before) = (free.len().min(wanted), self.simplices.len());
        let end = before + wanted - reused;
        if end > self.most {
            return Err(too_many(self.most));
        }
        self.simplices.reserve(end - before);
        self.spheres.reserve(end - before);
        places.clear();
        places.extend(free.drain(free.len() - reused..).rev());
        places.extend(before as u32..end as u32);
        Ok(end)
    }

    /// Makes places behind the arrays part of them, which have this length then.
    ///
    /// # Safety
    /// The places were reserved, and the simplices and spheres in them have been written.
    #[inline(always)]
    pub(super) unsafe fn extend(&mut self, len: usize) {
        // SAFETY: the promise of this function.
        unsafe {
            self.simplices.set_len(len);
            self.spheres.set_len(len);
        }
    }

    pub(super) fn point(&self, vertex: u32) -> Point4 {
        self.sites.points[self.order[vertex as usize] as usize]
    }

    #[inline(always)]
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

    #[inline(always)]
    pub(super) fn value(&self, simplex: usize, p: &Lifted) -> f64 {
        value(&self.spheres[simplex], p)
    }

    /// Whether vertex `q`, at `p`, is inside the sphere of a simplex.
    #[inline(always)]
    pub(super) fn is_in_conflict(&self, simplex: usize, q: u32, p: &Lifted) -> bool {
        let value = self.value(simplex, p);
        if self.is_clear(value, self.determinant(simplex).value()) {
            value < 0.0
        } else {
            self.decide(simplex, q, p)
        }
    }

    /// Whether the sign of a value is conclusive, for a sphere with the determinant m. Values of small
    /// integers are exact: zero means on the sphere.
    #[inline(always)]
    pub(super) fn is_clear(&self, value: f64, m: f64) -> bool {
        (value.abs() > self.rounding) | (self.is_exact() & (m != 0.0))
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
    #[inline(always)]
    pub(in crate::diagram4) fn neighbour_inside(&self, simplex: usize) -> Option<usize> {
        let simplex = &self.simplices[simplex];
        simplex.is_infinite().then(|| simplex_of(simplex.neighbours[simplex.faraway_side()]))
    }

    /// Whether values are free of rounding.
    #[inline(always)]
    fn is_exact(&self) -> bool {
        self.rounding == 0.0
    }

    /// Whether the neighbour across a facet is on the same sphere, or in the same hyperplane, because the
    /// opposite vertex is on that of the neighbour. The faraway point, at NaN, is not.
    #[inline(always)]
    pub(in crate::diagram4) fn is_cospherical(&self, simplex: usize, side: usize) -> bool {
        let Simplex { vertices, neighbours } = &self.simplices[simplex];
        let (vertex, other) = (vertices[side], simplex_of(neighbours[side]));
        self.value(other, &self.lifted(vertex)).abs() <= self.rounding
            && (self.is_exact() || self.exact_sign(other, vertex) == Ordering::Equal)
    }

    /// Prefetches the spheres around a simplex.
    #[inline(always)]
    pub(in crate::diagram4) fn fetch_spheres_around(&self, simplex: usize) {
        for neighbour in &self.simplices[simplex].neighbours {
            prefetch(&self.spheres, simplex_of(*neighbour));
        }
    }

    /// The sign of the value of a vertex.
    #[inline(always)]
    fn sign(&self, simplex: usize, q: u32) -> Ordering {
        let value = self.value(simplex, &self.lifted(q));
        if value.abs() > self.rounding {
            if value > 0.0 { Ordering::Greater } else { Ordering::Less }
        } else if self.is_exact() {
            Ordering::Equal
        } else {
            self.exact_sign(simplex, q)
        }
    }

    #[inline(never)]
    fn exact_sign(&self, simplex: usize, q: u32) -> Ordering {
        let Simplex { vertices, .. } = self.simplices[simplex];
        let point = self.point(q);
        let exactness = self.sites.exactness;
        if !self.simplices[simplex].is_infinite() {
            return in_sphere(exactness, vertices.map(|vertex| self.point(vertex)), point);
        }
        let side = self.simplices[simplex].faraway_side();
        let facet = without(vertices, side).map(|vertex| self.point(vertex));
        let sign = orientation(exactness, facet, point);
        if side == 0 { sign.reverse() } else { sign }
    }
}

#[cold]
fn too_many(most: usize) -> Error {
    Error::new(ErrorKind::Io, format!("more than {most} simplices, the most that a diagram can be made of"))
}

/// The spheres of simplices, each of four given vertices and, as the last, the one at `o`; for infinite
/// simplices, the hyperplanes.
///
/// The row of a vertex is (x, |x|^2), seen from `o`. That of the faraway point, which is the first or the
/// second, is (0, 1), the limit of rows of points far away, divided by their lift.
#[inline(always)]
pub(super) fn spheres_of<C: Coefficient, L: Lanes>(
    token: L::Token,
    points: &[Point4],
    o: &Point4,
    facets: &[[u32; 4]; LANES],
) -> [Sphere<C>; LANES] {
    let splat = |x: f64| L::new(token, [x; LANES]);
    let origin = [splat(o[0]), splat(o[1]), splat(o[2]), splat(o[3])];
    let vectors = |i: usize| vectors(token, points, facets, i, &origin);
    let (a, b, c, d) = (vectors(0), vectors(1), vectors(2), vectors(3));
    let (a_lift, b_lift) = (lift(&a).or(1.0), lift(&b).or(1.0));
    let finite = |[x, y, z, t]: [L; 4]| [x.or(0.0), y.or(0.0), z.or(0.0), t.or(0.0)];
    let (a, b) = (finite(a), finite(b));
    let (n, m) = lifted_sphere([(&a, a_lift), (&b, b_lift), (&c, lift(&c)), (&d, lift(&d))]);
    let s = (m * lift(&origin) - dot(&n, &origin)).array();
    let twice = m + m;
    let shifted = |axis: usize| n[axis] - twice * origin[axis];
    let n = L::columns([shifted(0), shifted(1), shifted(2), shifted(3)]);
    let m = m.array();
    let sphere = |lane: usize| -> Sphere<C> {
        let [x, y, z, t] = n[lane].array();
        let is_infinite = facets[lane][0].min(facets[lane][1]) == INFINITE;
        let m = C::determinant(m[lane], is_infinite);
        [C::of(x), C::of(y), C::of(z), C::of(t), m, C::of(s[lane])]
    };
    [sphere(0), sphere(1), sphere(2), sphere(3)]
}

/// The vectors from an origin to a vertex of each facet, axis by axis.
#[inline(always)]
fn vectors<L: Lanes>(
    token: L::Token,
    points: &[Point4],
    facets: &[[u32; 4]; LANES],
    i: usize,
    origin: &[L; 4],
) -> [L; 4] {
    let near = |lane: usize| L::new(token, points[facets[lane][i] as usize]);
    difference(L::columns([near(0), near(1), near(2), near(3)]), origin)
}

/// The product of a sphere and a point.
#[inline(always)]
pub(super) fn value<C: Coefficient>(sphere: &Sphere<C>, p: &Lifted) -> f64 {
    let [a, b, c, d, m, s] = *sphere;
    let product = |x: C, i: usize| x.value() * p[i];
    let (even, odd) = (product(a, 0) + product(c, 2), product(b, 1) + product(d, 3));
    (even + product(m, 4)) + (odd + product(s, 5))
}

impl Simplex {
    /// Whether the faraway point is a vertex.
    #[inline(always)]
    pub(in crate::diagram4) fn is_infinite(&self) -> bool {
        self.vertices[0].min(self.vertices[1]) == INFINITE
    }

    /// The place of the faraway point in an infinite simplex: it is the least vertex.
    #[inline(always)]
    pub(in crate::diagram4) fn faraway_side(&self) -> usize {
        usize::from(self.vertices[1] == INFINITE)
    }
}

#[inline(always)]
pub(in crate::diagram4) fn without(vertices: [u32; FACETS], side: usize) -> [u32; 4] {
    std::array::from_fn(|i| vertices[i + usize::from(i >= side)])
}

/// The simplices and spheres in arrays, and in the room behind them.
///
/// New simplices are written to the room directly, not over dummies. Indices come from the kernel's own
/// arrays, so only debug builds, which tests are, check them. Together this saves up to 3 % of the time.
#[derive(Debug)]
pub(super) struct Arrays<'s, C> {
    simplices: *mut Simplex,
    spheres: *mut Sphere<C>,
    /// How many there is room for.
    len: usize,
    arrays: PhantomData<&'s mut [Sphere<C>]>,
}

impl<'s, C: Coefficient> Arrays<'s, C> {
    /// The simplices and spheres of arrays, and of the room behind them.
    ///
    /// # Safety
    /// All facets and simplices that this is used with are in the arrays or in the room behind them, and what
    /// is read from the room was written.
    pub(super) unsafe fn of(
        simplices: &'s mut Vec<Simplex>,
        spheres: &'s mut Vec<Sphere<C>>,
    ) -> Arrays<'s, C> {
        let len = simplices.capacity().min(spheres.capacity());
        Arrays { simplices: simplices.as_mut_ptr(), spheres: spheres.as_mut_ptr(), len, arrays: PhantomData }
    }

    #[inline(always)]
    pub(super) fn vertices(&self, simplex: usize) -> [u32; FACETS] {
        debug_assert!(simplex < self.len);
        // SAFETY: the promise made to `of`.
        unsafe { (*self.simplices.add(simplex)).vertices }
    }

    #[inline(always)]
    pub(super) fn neighbour(&self, facet: Facet) -> Facet {
        debug_assert!(simplex_of(facet) < self.len);
        // SAFETY: the promise made to `of`.
        unsafe { (*self.simplices.add(simplex_of(facet))).neighbours[facet_of(facet)] }
    }

    #[inline(always)]
    pub(super) fn set_neighbour(&mut self, facet: Facet, neighbour: Facet) {
        debug_assert!(simplex_of(facet) < self.len);
        // SAFETY: the promise made to `of`.
        unsafe { (*self.simplices.add(simplex_of(facet))).neighbours[facet_of(facet)] = neighbour }
    }

    #[inline(always)]
    pub(super) fn set(&mut self, simplex: usize, vertices: [u32; FACETS], sphere: Sphere<C>) {
        debug_assert!(simplex < self.len);
        // SAFETY: the promise made to `of`.
        unsafe {
            (*self.simplices.add(simplex)).vertices = vertices;
            *self.spheres.add(simplex) = sphere;
        }
    }
}

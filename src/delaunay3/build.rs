//! The first tetrahedron, then point after point.

use super::complex::Complex;
use super::insertion::{Cavity, Insertion};
use super::lanes::Lanes;
use super::rounds;
use super::stats::{Clock, Stats};
use super::tetrahedralization::{Tetrahedron, Vertex};
use crate::predicates::{Point3, Predicates3, Sign};
use std::marker::PhantomData;

/// Tetrahedralizes distinct points, all in one arithmetic.
pub(super) struct Build<'a> {
    /// The vertices, that at infinity last.
    pub(super) vertices: Vec<Vertex>,
    /// Memory for the tetrahedra.
    pub(super) tetrahedra: Vec<Tetrahedron>,
    pub(super) cavity: &'a mut Cavity,
    pub(super) stats: &'a mut Stats,
    pub(super) is_timed: bool,
    /// See [`Insertion`].
    pub(super) infinite_lift: f64,
}

impl Build<'_> {
    /// The complex; all is given back if the points lie in a plane.
    ///
    /// Inlined, like all that it calls with lanes, into functions for one kind of processor each.
    #[inline(always)]
    pub(super) fn run<P: Predicates3, L: Lanes>(self, predicates: &mut P) -> Result<Complex, Self> {
        let Some(first) = self.first_tetrahedron(predicates) else { return Err(self) };
        let count = self.vertices.len() as u32 - 1;
        self.cavity.clear();
        let mut insertion = Insertion::<P, L> {
            complex: Complex::new(self.vertices, self.tetrahedra, first),
            predicates,
            cavity: self.cavity,
            stats: self.stats,
            clock: Clock::new(self.is_timed),
            infinite_lift: self.infinite_lift,
            unfiltered: 0,
            lanes: PhantomData,
        };
        insertion.stats.created = 5;
        let mut start = 0;
        for vertex in rounds::strided(count) {
            if !first.contains(&vertex) {
                start = insertion.insert(vertex, start);
            }
        }
        Ok(insertion.finish())
    }

    /// The first four vertices that are not in a plane, positively oriented.
    fn first_tetrahedron<P: Predicates3>(&self, predicates: &mut P) -> Option<[u32; 4]> {
        let point = |v: u32| self.vertices[v as usize].at;
        let mut sequence = rounds::strided(self.vertices.len() as u32 - 1);
        let (a, b) = (sequence.next()?, sequence.next()?);
        let c = sequence.find(|&c| !is_line(point(a), point(b), point(c), predicates))?;
        let mut orientation = Sign::Zero;
        let d = sequence.find(|&d| {
            orientation = predicates.orient3d(point(a), point(b), point(c), point(d));
            orientation != Sign::Zero
        })?;
        Some(if orientation == Sign::Positive { [a, b, c, d] } else { [b, a, c, d] })
    }
}

/// Whether three points lie on a line: so do then their projections along all axes.
fn is_line<P: Predicates3>(a: Point3, b: Point3, c: Point3, predicates: &mut P) -> bool {
    [(0, 1), (1, 2), (2, 0)].into_iter().all(|(i, j)| {
        let [p, q, r] = [a, b, c].map(|point| [point[i], point[j], 0.0]);
        predicates.orient3d(p, q, r, [p[0], p[1], 1.0]) == Sign::Zero
    })
}

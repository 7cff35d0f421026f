//! The first tetrahedron, then point after point.

use super::MAX_POINTS;
use super::complex::Complex;
use super::exact::Exact;
use super::insertion::{Cavity, Insertion};
use super::lanes::Lanes;
use super::stats::{PhaseTimer, Stats};
use super::tetrahedralization::{Tetrahedron, Vertex};
use super::weights::Weights;
use crate::order::Insertions;
use crate::predicates::{Point3, Sign};

/// Tetrahedralizes distinct points, all in one arithmetic.
pub(super) struct Build<'a, W> {
    /// The vertices, that at infinity last.
    pub(super) vertices: Vec<Vertex>,
    pub(super) weights: W,
    /// Memory for the tetrahedra.
    pub(super) tetrahedra: Vec<Tetrahedron>,
    pub(super) cavity: &'a mut Cavity,
    pub(super) stats: &'a mut Stats,
    pub(super) is_timed: bool,
    /// Whether portable instructions are used only.
    pub(super) is_portable: bool,
    /// The numbers of the vertices in the order of insertion.
    pub(super) insertions: Insertions,
    /// See [`Insertion`].
    pub(super) infinite_lift: f64,
}

/// The result of a build.
pub(super) enum Built {
    /// The whole.
    Complex(Complex),
    /// Nothing, because all points lie in a plane; the memory is given back.
    Flat(Vec<Vertex>, Vec<Tetrahedron>),
    /// More tetrahedra than can be numbered.
    TooMany,
}

/// Greatest number of tetrahedra. It leaves numbers for one more star of all vertices.
pub(super) const TETRAHEDRA_MAX: usize = (1 << 29) - 2 * MAX_POINTS;

impl<W: Weights> Build<'_, W> {
    /// The complex.
    ///
    /// Inlined, like everything that it calls with lanes, into one function per kind of processor.
    #[inline(always)]
    pub(super) fn run<L: Lanes>(self, predicates: &mut dyn Exact, token: L::Token) -> Built {
        let Some(first) = self.first_tetrahedron(predicates) else {
            return Built::Flat(self.vertices, self.tetrahedra);
        };
        self.cavity.clear();
        let mut insertion = Insertion::<L, W> {
            complex: Complex::new(self.vertices, self.tetrahedra, first),
            weights: &self.weights,
            predicates,
            cavity: self.cavity,
            stats: self.stats,
            timer: PhaseTimer::new(self.is_timed),
            infinite_lift: self.infinite_lift,
            unfiltered: 0,
            token,
        };
        insertion.stats.created = 5;
        let mut start = 0;
        for vertex in self.insertions {
            if !first.contains(&vertex) {
                start = insertion.insert(vertex, start);
                if insertion.complex.tetrahedra.len() > TETRAHEDRA_MAX {
                    return Built::TooMany;
                }
            }
        }
        Built::Complex(insertion.finish())
    }

    /// The first four vertices that are not in a plane, positively oriented.
    fn first_tetrahedron(&self, predicates: &mut dyn Exact) -> Option<[u32; 4]> {
        let point = |v: u32| self.vertices[v as usize].at;
        let mut sequence = self.insertions.clone();
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
fn is_line(a: Point3, b: Point3, c: Point3, predicates: &mut dyn Exact) -> bool {
    [(0, 1), (1, 2), (2, 0)].into_iter().all(|(i, j)| {
        let [p, q, r] = [a, b, c].map(|point| [point[i], point[j], 0.0]);
        predicates.orient3d(p, q, r, [p[0], p[1], 1.0]) == Sign::Zero
    })
}

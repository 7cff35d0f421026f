//! The predicates of space, as [`super::Predicates2`] and [`super::Arithmetic`] are those of the plane.
//!
//! A tetrahedron abcd is positively oriented if det(b - a, c - a, d - a) > 0: seen from d, the triangle abc
//! is counterclockwise; the thumb of the right hand points to d if the fingers go from a to b to c.

pub(crate) mod filter;
mod float;
mod integer;
mod power;

pub use float::{BoundedFloatPredicates3, FiniteFloatPredicates3};
pub use integer::{IntegerPredicates3, SmallIntegerPredicates3, Width3};

use super::{Extent, Int64, Int128, Numbers, Point3, PredicateCounts, Sign, perturbation};

/// The predicates of 3D Delaunay triangulation in one arithmetic. Implementations count their decisions.
pub trait Predicates3 {
    /// The numbers that this arithmetic is for: a caller may have a filter of its own for some.
    const NUMBERS: Numbers;

    /// Orientation of the tetrahedron abcd: the sign of det(b - a, c - a, d - a), zero if coplanar.
    fn orient3d(&mut self, a: Point3, b: Point3, c: Point3, d: Point3) -> Sign;

    /// Side of e against the sphere through a, b, c, d: positive inside, zero on it.
    ///
    /// Domain: abcd positively oriented (the sign flips if it is negatively oriented).
    fn insphere(&mut self, a: Point3, b: Point3, c: Point3, d: Point3, e: Point3) -> Sign;

    /// [`Predicates3::insphere`] with ties broken by the canonical perturbation: never zero in its domain.
    ///
    /// The lift of each point is raised by an infinitesimal that depends on its lexicographic rank (x, then
    /// y, then z); the larger rank dominates. Only the order of the coordinates matters, so the answer does
    /// not depend on the order of insertion, and since no point is moved in space, no tetrahedron is flat.
    ///
    /// Domain: abcd positively oriented, all five points distinct.
    ///
    /// Source: Devillers and Teillaud, "Perturbations for Delaunay and weighted Delaunay 3D triangulations",
    /// 2011; same rule as CGAL's `Delaunay_triangulation_3`.
    #[inline(always)]
    fn insphere_perturbed(&mut self, a: Point3, b: Point3, c: Point3, d: Point3, e: Point3) -> Sign {
        match self.insphere(a, b, c, d, e) {
            Sign::Zero => perturbation::cospherical(self, [a, b, c, d], e),
            sign => sign,
        }
    }

    /// Side of e against the orthosphere of a, b, c, d, given the weights of all five in this order: positive
    /// if e is in conflict, which means that its power distance is below its weight. Ties as in
    /// [`Predicates3::insphere_perturbed`]: never zero in its domain.
    ///
    /// Domain: abcd positively oriented, all five points distinct, weights finite.
    fn power_side_perturbed(&mut self, abcd: [Point3; 4], e: Point3, weights: [f64; 5]) -> Sign {
        match power::power_side(abcd, e, weights, self.counts_mut()) {
            Sign::Zero => perturbation::cospherical(self, abcd, e),
            sign => sign,
        }
    }

    /// Decisions so far, by stage.
    fn counts(&self) -> &PredicateCounts;

    /// Decisions so far, to be written by the perturbation.
    fn counts_mut(&mut self) -> &mut PredicateCounts;
}

/// An algorithm that works with predicates of space of any arithmetic.
pub trait WithPredicates3 {
    /// What it computes.
    type Output;
    /// Runs with `predicates`, which are exact for the points that their arithmetic was chosen for.
    fn with(self, predicates: &mut impl Predicates3) -> Self::Output;
}

/// Which arithmetic is exact for a chunk of points of space, cheapest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arithmetic3 {
    /// Integers whose differences are small enough for plain `f64` to be exact throughout.
    SmallInteger,
    /// Integers; `i64` decides where the filter does not.
    Integer64,
    /// Integers; `i128` decides where the filter does not.
    Integer128,
    /// Wider integers, and floating point in the range where products of coordinates neither over- nor underflow.
    BoundedFloat,
    /// All finite floating-point numbers.
    FiniteFloat,
}

impl Arithmetic3 {
    /// Cheapest arithmetic that is exact for all points within `extent`.
    pub fn of(extent: &Extent<3>) -> Arithmetic3 {
        let difference = extent.max_difference();
        if extent.integral && difference <= Int128::MAX_SIDE {
            if difference <= SmallIntegerPredicates3::MAX_SIDE {
                Arithmetic3::SmallInteger
            } else if difference <= Int64::MAX_SIDE {
                Arithmetic3::Integer64
            } else {
                Arithmetic3::Integer128
            }
        } else if BoundedFloatPredicates3::covers(extent) {
            Arithmetic3::BoundedFloat
        } else {
            Arithmetic3::FiniteFloat
        }
    }

    /// Runs `algorithm` in this arithmetic and adds its decisions to `counts`.
    pub fn run<A: WithPredicates3>(self, algorithm: A, counts: &mut PredicateCounts) -> A::Output {
        fn counted<A: WithPredicates3, P: Predicates3>(
            algorithm: A,
            mut predicates: P,
            counts: &mut PredicateCounts,
        ) -> A::Output {
            let output = algorithm.with(&mut predicates);
            counts.merge(predicates.counts());
            output
        }
        match self {
            Arithmetic3::SmallInteger => counted(algorithm, SmallIntegerPredicates3::default(), counts),
            Arithmetic3::Integer64 => counted(algorithm, IntegerPredicates3::<Int64>::default(), counts),
            Arithmetic3::Integer128 => counted(algorithm, IntegerPredicates3::<Int128>::default(), counts),
            Arithmetic3::BoundedFloat => counted(algorithm, BoundedFloatPredicates3::default(), counts),
            Arithmetic3::FiniteFloat => counted(algorithm, FiniteFloatPredicates3::default(), counts),
        }
    }
}

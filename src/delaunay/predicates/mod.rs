//! Exact predicates of computational geometry, independent of any mesh.
//!
//! All arithmetics give the right sign; they differ in cost. [`Arithmetic::of`] examines the coordinates of a
//! chunk once and picks the cheapest arithmetic that is exact for all of them; [`Arithmetic::run`] then runs
//! an algorithm monomorphised for it. A caller without a chunk, or with a few calls only, uses
//! [`FiniteFloatPredicates`]. In space, [`Arithmetic3`] and [`FiniteFloatPredicates3`] do the same.
//! [`area()`] computes an accurate area.
//!
//! ```
//! use spmesh_delaunay::predicates::{FiniteFloatPredicates, Predicates2, Sign};
//!
//! // In `f64`, all products of this determinant underflow to zero.
//! let sign = FiniteFloatPredicates::default().orient2d([0.0, 0.0], [1e-200, 1e-200], [1e-200, 2e-200]);
//! assert_eq!(sign, Sign::Positive);
//! ```

/// What all predicates with a field `counts` say of it.
macro_rules! counting {
    () => {
        fn counts(&self) -> &PredicateCounts {
            &self.counts
        }

        fn counts_mut(&mut self) -> &mut PredicateCounts {
            &mut self.counts
        }
    };
}

mod adaptive;
mod area;
mod big;
mod centre;
pub mod circle;
mod counts;
mod distance;
// Hidden: for the kernels of other crates of the workspace.
#[doc(hidden)]
pub mod exact;
pub mod exact_integers;
mod extent;
#[doc(hidden)]
pub mod forms;
mod integer;
mod pairs;
mod perturbation;
#[doc(hidden)]
pub mod residues;
pub(crate) mod spatial;
pub mod sphere;

pub use adaptive::{BoundedFloatPredicates, FiniteFloatPredicates};
pub(crate) use adaptive::{Estimate, INCIRCLE_BOUND};
pub use area::{area, exact_area};
pub(crate) use centre::{Centre2, circumcentre2, circumcentre3, is_bounded, numerators2};
pub use counts::PredicateCounts;
pub(crate) use distance::nearer;
pub use extent::Extent;
pub use integer::{Int64, Int128, IntPair, IntegerPredicates, SmallIntegerPredicates, Width};
pub use pairs::Pair;
pub use perturbation::lexicographic;
pub(crate) use spatial::filter::{
    INSPHERE_SQUARED_BOUND, POWER_SQUARED_BOUND, TINY, insphere_is_certain, orient3d_is_certain,
    power_is_certain,
};
pub use spatial::{
    Arithmetic3, BoundedFloatPredicates3, FiniteFloatPredicates3, IntegerPredicates3, Predicates3,
    SmallIntegerPredicates3, Width3, WithPredicates3,
};

pub use crate::points::{Point2, Point3};

/// Sign of an exactly evaluated expression.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Sign {
    /// Below zero.
    Negative = -1,
    /// Exactly zero.
    Zero = 0,
    /// Above zero.
    Positive = 1,
}

impl Sign {
    /// Sign of `value` compared with the zero of its type.
    #[inline(always)]
    pub fn of<T: PartialOrd + Default>(value: T) -> Sign {
        let zero = T::default();
        if value > zero {
            Sign::Positive
        } else if value < zero {
            Sign::Negative
        } else {
            Sign::Zero
        }
    }

    /// The sign of the negative value.
    #[inline(always)]
    pub fn opposite(self) -> Sign {
        match self {
            Sign::Negative => Sign::Positive,
            Sign::Zero => Sign::Zero,
            Sign::Positive => Sign::Negative,
        }
    }
}

/// The coordinates that an arithmetic is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Numbers {
    /// Integers whose differences fit into integers of a fixed width.
    Integers,
    /// Finite numbers whose products of four factors (in space: five) neither overflow nor underflow.
    BoundedFloats,
    /// All finite numbers.
    FiniteFloats,
}

/// The predicates of 2D Delaunay triangulation in one arithmetic. Implementations count their decisions.
pub trait Predicates2 {
    /// The numbers that this arithmetic is for: a caller may have a filter of its own for some.
    const NUMBERS: Numbers;

    /// Orientation of the triangle abc: positive if counterclockwise, zero if collinear.
    fn orient2d(&mut self, a: Point2, b: Point2, c: Point2) -> Sign;

    /// Side of d against the circle through a, b, c: positive inside, zero on it.
    ///
    /// Domain: abc counterclockwise (the sign flips if it is clockwise).
    fn incircle(&mut self, a: Point2, b: Point2, c: Point2, d: Point2) -> Sign;

    /// [`Predicates2::incircle`] with ties broken by the canonical perturbation: never zero in its domain.
    ///
    /// The lift of each point is raised by an infinitesimal that depends on its lexicographic rank (x, then
    /// y); the larger rank dominates. Only the order of the four coordinates matters, so the answer does not
    /// depend on the order of insertion.
    ///
    /// Domain: abc counterclockwise, all four points distinct.
    ///
    /// Source: Devillers and Teillaud, "Perturbations for Delaunay and weighted Delaunay 3D triangulations",
    /// 2011; same rule as CGAL's `Delaunay_triangulation_2`.
    #[inline(always)]
    fn incircle_perturbed(&mut self, a: Point2, b: Point2, c: Point2, d: Point2) -> Sign {
        match self.incircle(a, b, c, d) {
            Sign::Zero => perturbation::cocircular(self, a, b, c, d),
            sign => sign,
        }
    }

    /// Decisions so far, by stage.
    fn counts(&self) -> &PredicateCounts;

    /// Decisions so far, to be written by the perturbation.
    fn counts_mut(&mut self) -> &mut PredicateCounts;
}

/// An algorithm that works with predicates of any arithmetic.
pub trait WithPredicates2 {
    /// What it computes.
    type Output;
    /// Runs with `predicates`, which are exact for the points that their arithmetic was chosen for.
    fn with(self, predicates: &mut impl Predicates2) -> Self::Output;
}

/// Which arithmetic is exact for a chunk of points, cheapest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arithmetic {
    /// Integers whose differences are small enough for plain `f64` to be exact throughout.
    SmallInteger,
    /// Integers; `i64` decides where the filter does not.
    Integer64,
    /// Integers; `i128` decides where the filter does not.
    Integer128,
    /// Integers of the full `i32` range and beyond; pairs of `i128` decide where the filter does not.
    IntegerPair,
    /// Floating point in the range where products of coordinates neither over- nor underflow.
    BoundedFloat,
    /// All finite floating-point numbers.
    FiniteFloat,
}

impl Arithmetic {
    /// Cheapest arithmetic that is exact for all points within `extent`.
    pub fn of(extent: &Extent) -> Arithmetic {
        let difference = extent.max_difference();
        if extent.integral && difference <= IntPair::MAX_DIFFERENCE {
            if difference <= SmallIntegerPredicates::MAX_DIFFERENCE {
                Arithmetic::SmallInteger
            } else if difference <= Int64::MAX_DIFFERENCE {
                Arithmetic::Integer64
            } else if difference <= Int128::MAX_DIFFERENCE {
                Arithmetic::Integer128
            } else {
                Arithmetic::IntegerPair
            }
        } else if BoundedFloatPredicates::covers(extent) {
            Arithmetic::BoundedFloat
        } else {
            Arithmetic::FiniteFloat
        }
    }

    /// Runs `algorithm` in this arithmetic and adds its decisions to `counts`.
    pub fn run<A: WithPredicates2>(self, algorithm: A, counts: &mut PredicateCounts) -> A::Output {
        fn counted<A: WithPredicates2, P: Predicates2>(
            algorithm: A,
            mut predicates: P,
            counts: &mut PredicateCounts,
        ) -> A::Output {
            let output = algorithm.with(&mut predicates);
            counts.merge(predicates.counts());
            output
        }
        match self {
            Arithmetic::SmallInteger => counted(algorithm, SmallIntegerPredicates::default(), counts),
            Arithmetic::Integer64 => counted(algorithm, IntegerPredicates::<Int64>::default(), counts),
            Arithmetic::Integer128 => counted(algorithm, IntegerPredicates::<Int128>::default(), counts),
            Arithmetic::IntegerPair => counted(algorithm, IntegerPredicates::<IntPair>::default(), counts),
            Arithmetic::BoundedFloat => counted(algorithm, BoundedFloatPredicates::default(), counts),
            Arithmetic::FiniteFloat => counted(algorithm, FiniteFloatPredicates::default(), counts),
        }
    }
}

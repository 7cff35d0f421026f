//! A filter that costs one comparison, in front of an arithmetic that settles what it leaves.
//!
//! With D the greatest difference of two coordinates of an axis in the chunk, the sums of magnitudes of
//! [`Estimate`] are at most 2 D^2 for `orient2d` and 12 D^4 for `incircle`, but for rounding. So the bounds on their
//! errors have an upper bound that is the same for all tests of the chunk. Neighbours in a chunk of n points are
//! about D / sqrt(n) apart, and the determinant of a test between them is about D^4 / n^2: among a million points that
//! is still 75 times the bound.

use super::adaptive::{Estimate, INCIRCLE_BOUND, ORIENT2D_BOUND, difference};
use super::{Extent, Point2, PredicateCounts, Predicates2, Sign};
use std::marker::PhantomData;

/// Above 1 by more than all roundings in the magnitudes and in the bounds together can take away.
const MARGIN: f64 = 1.0 + 1e-12;

/// An arithmetic that is exact for all points of a chunk, of which a value in `f64` did not tell the sign.
pub trait ExactStage: Default {
    /// Orientation, given its estimate.
    fn orient2d(points: [Point2; 3], counts: &mut PredicateCounts) -> Sign;
    /// In-circle sign.
    fn incircle(points: [Point2; 4], counts: &mut PredicateCounts) -> Sign;
}

/// Filter of the chunk, then the arithmetic `E`.
#[derive(Debug)]
pub struct FilteredPredicates<E> {
    orient2d_error: f64,
    incircle_error: f64,
    counts: PredicateCounts,
    exact: PhantomData<E>,
}

impl<E: ExactStage> FilteredPredicates<E> {
    /// Predicates for the points within `extent`.
    #[must_use]
    pub fn new(extent: &Extent) -> Self {
        let square = extent.max_difference().powi(2) * MARGIN;
        FilteredPredicates {
            orient2d_error: ORIENT2D_BOUND * MARGIN * 2.0 * square,
            incircle_error: INCIRCLE_BOUND * MARGIN * 12.0 * square * square,
            counts: PredicateCounts::default(),
            exact: PhantomData,
        }
    }
}

impl<E: ExactStage> Predicates2 for FilteredPredicates<E> {
    #[inline(always)]
    fn orient2d(&mut self, a: Point2, b: Point2, c: Point2) -> Sign {
        let value = Estimate::orient2d(difference(a, c), difference(b, c)).value;
        self.counts.filter += 1;
        if value > self.orient2d_error {
            Sign::Positive
        } else if value < -self.orient2d_error {
            Sign::Negative
        } else {
            self.counts.filter -= 1;
            E::orient2d([a, b, c], &mut self.counts)
        }
    }

    #[inline(always)]
    fn incircle(&mut self, a: Point2, b: Point2, c: Point2, d: Point2) -> Sign {
        let value = Estimate::incircle(difference(a, d), difference(b, d), difference(c, d)).value;
        self.counts.filter += 1;
        if value > self.incircle_error {
            Sign::Positive
        } else if value < -self.incircle_error {
            Sign::Negative
        } else {
            self.counts.filter -= 1;
            E::incircle([a, b, c, d], &mut self.counts)
        }
    }

    fn counts(&self) -> &PredicateCounts {
        &self.counts
    }

    fn counts_mut(&mut self) -> &mut PredicateCounts {
        &mut self.counts
    }
}

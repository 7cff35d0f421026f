//! The predicates as a trait object. They are called only where the filter does not decide, which is rare, so
//! the rest of the kernel is compiled once and not for each arithmetic.

use crate::predicates::{Numbers, Point3, PredicateCounts, Predicates3, Sign};

/// [`Predicates3`] of an arithmetic that is known when the program runs.
pub(super) trait Exact {
    /// Coordinates are integers whose differences are exact.
    fn is_integer(&self) -> bool;
    fn orient3d(&mut self, a: Point3, b: Point3, c: Point3, d: Point3) -> Sign;
    fn insphere_perturbed(&mut self, a: Point3, b: Point3, c: Point3, d: Point3, e: Point3) -> Sign;
    fn power_side_perturbed(&mut self, abcd: [Point3; 4], e: Point3, weights: [f64; 5]) -> Sign;
    fn counts_mut(&mut self) -> &mut PredicateCounts;
}

impl<P: Predicates3> Exact for P {
    fn is_integer(&self) -> bool {
        P::NUMBERS == Numbers::Integers
    }

    fn orient3d(&mut self, a: Point3, b: Point3, c: Point3, d: Point3) -> Sign {
        Predicates3::orient3d(self, a, b, c, d)
    }

    fn insphere_perturbed(&mut self, a: Point3, b: Point3, c: Point3, d: Point3, e: Point3) -> Sign {
        Predicates3::insphere_perturbed(self, a, b, c, d, e)
    }

    fn power_side_perturbed(&mut self, abcd: [Point3; 4], e: Point3, weights: [f64; 5]) -> Sign {
        Predicates3::power_side_perturbed(self, abcd, e, weights)
    }

    fn counts_mut(&mut self) -> &mut PredicateCounts {
        Predicates3::counts_mut(self)
    }
}

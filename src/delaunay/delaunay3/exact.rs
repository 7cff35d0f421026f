//! What is decided exactly: ties by values without rounding errors, all else by the predicates as a trait
//! object. They are called only where the filter does not decide, which is rare, so
//! the rest of the kernel is compiled once and not for each arithmetic.

use super::translated::InSphere;
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

/// If the greatest lift is below this, nothing was rounded: with integers, all that the in-sphere determinant
/// is made of is below 2^53, because the sum of the magnitudes of its products is at most 8/sqrt(3) times the
/// power 2.5 of the greatest lift ([`crate::predicates::spatial::filter`]).
pub(super) const EXACT: f64 = 1.3e6;
const _: () = assert!(
    64.0 / 3.0 * (EXACT * EXACT * EXACT * EXACT * EXACT) < 9_007_199_254_740_992.0 * 9_007_199_254_740_992.0
);

/// Whether the new point, which is the origin, is in the sphere of a tetrahedron by the canonical
/// perturbation, although it lies on it.
///
/// Of the five points that of greatest rank decides whose lift makes a difference: if it is a corner, by the
/// orientation of the tetrahedron with the origin in its place, which is the volume under the facet opposite
/// to it; if it is the origin, which would be raised out of the sphere, by no.
pub(super) fn is_inside(test: &InSphere) -> bool {
    let mut decisive = ([0.0; 3], -1.0);
    for (corner, &volume) in test.corners.iter().zip(&test.volumes) {
        if volume != 0.0 && is_above(corner.at, decisive.0) {
            decisive = (corner.at, volume);
        }
    }
    decisive.1 > 0.0
}

#[inline(always)]
fn is_above(p: Point3, q: Point3) -> bool {
    p[0] > q[0] || (p[0] == q[0] && (p[1] > q[1] || (p[1] == q[1] && p[2] > q[2])))
}

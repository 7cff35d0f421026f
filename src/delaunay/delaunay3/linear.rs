//! Linear interpolation in the tetrahedron that contains the target.

use super::tetrahedralization::Tetrahedralization;
use crate::predicates::exact_integers::{integers, quotient};
use crate::predicates::forms::{Form, Orient3d};
use crate::predicates::{BoundedFloatPredicates3, Estimate, Point3, Sign};
use crate::simplex::{TETRAHEDRON_FACETS, weighted_sum};
use crate::vector::difference;
use crate::walk::{Arrival, Walker};
use num_bigint::BigInt;

/// Greatest error of a weight.
const WEIGHT_ERROR: f64 = 1e-13;

/// Interpolates linearly in each tetrahedron. It remembers the tetrahedron of its last target.
#[derive(Debug)]
pub struct Linear<'m> {
    walker: Walker<'m, Tetrahedralization, 3, 4>,
}

impl<'m> Linear<'m> {
    /// An interpolator of values at the vertices of `mesh`.
    pub fn new(mesh: &'m Tetrahedralization) -> Linear<'m> {
        Linear { walker: Walker::new(mesh) }
    }

    /// The corners of a tetrahedron that contains the target, with its barycentric coordinates; the least
    /// tetrahedron, if there are several. `None` outside of the hull, without tetrahedra, and if the target
    /// is not finite.
    ///
    /// Each weight is off by less than 1e-13; it is zero exactly where the target is on the opposite facet,
    /// and one at the corner.
    ///
    /// Cost: a walk from the tetrahedron of the last target, or from one of [`Tetrahedralization::starts`].
    pub fn weights(&mut self, target: Point3) -> Option<[(u32, f64); 4]> {
        let Arrival::Inside(found, sides) = self.walker.walk(target)? else { return None };
        let (mesh, number) = (self.walker.mesh, self.walker.least(found, sides, target));
        let vertices = mesh.tetrahedra[number as usize].vertices.map(|v| mesh.vertices[v as usize]);
        let mut weights = barycentric(vertices.map(|vertex| vertex.at), target);
        if sides.contains(&Sign::Zero) {
            for (corner, weight) in weights.iter_mut().enumerate() {
                if self.walker.side(number, corner, target) == Sign::Zero {
                    *weight = 0.0;
                }
            }
            // The others still have the sum that they had.
            let total: f64 = weights.iter().sum();
            weights = weights.map(|weight| weight / total);
        }
        Some([0, 1, 2, 3].map(|corner| (vertices[corner].index, weights[corner])))
    }

    /// The value at the target, for values at the input points; that at a vertex is exactly its own. `None`
    /// where there are no weights. Values of duplicates do not count.
    ///
    /// # Panics
    /// If there are fewer values than points.
    pub fn interpolate(&mut self, values: &[f64], target: Point3) -> Option<f64> {
        self.weights(target).map(|weights| weighted_sum(&weights, |v| values[v as usize]))
    }
}

/// Barycentric coordinates of a target in a closed tetrahedron.
fn barycentric(corners: [Point3; 4], target: Point3) -> [f64; 4] {
    // Products of three differences neither overflow nor underflow then, with room for the sum of six of
    // them.
    if corners.iter().chain([&target]).all(BoundedFloatPredicates3::covers_point) {
        let to = corners.map(|corner| difference(corner, target));
        let volumes = TETRAHEDRON_FACETS.map(|facet| Estimate::orient3d(facet.map(|i| to[i])));
        let total: f64 = volumes.iter().map(|volume| volume.value).sum();
        let error: f64 = volumes.iter().map(|volume| volume.bound * volume.magnitude).sum();
        // A weight is off by the errors of its volume and of the total, whose sum is rounded, too, and of the
        // quotient: less than three times the errors of all volumes. Twice that is on the safe side.
        if 6.0 * error <= WEIGHT_ERROR * total {
            return volumes.map(|volume| volume.value.max(0.0) / total);
        }
    }
    let [a, b, c, d, target] = integers([corners[0], corners[1], corners[2], corners[3], target]);
    let to = [a, b, c, d].map(|corner| [0, 1, 2].map(|axis| &corner[axis] - &target[axis]));
    let volumes =
        TETRAHEDRON_FACETS.map(|facet| Orient3d::value(&facet.map(|i| to[i].clone()), |_| BigInt::ZERO));
    let total = volumes.iter().sum();
    volumes.map(|volume| quotient(&volume, &total, 0))
}

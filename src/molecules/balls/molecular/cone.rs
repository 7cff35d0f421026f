//! Cones over spherical polygons.

use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::vector::{cross, dot};

/// A convex cone with its apex at the origin.
#[derive(Debug, Clone, Default)]
pub(super) struct Cone {
    /// Rays of length 1, counterclockwise as seen from outside.
    rays: Vec<Point3>,
}

impl Cone {
    /// The cone of three rays of length 1.
    pub(super) fn of(rays: [Point3; 3]) -> Cone {
        Cone { rays: rays.to_vec() }
    }

    /// A bound of the cosine of the angle between its rays and a direction of length 1.
    pub(super) fn nearness(&self, direction: Point3) -> f64 {
        let sum = self.rays.iter().fold([0.0; 3], |sum, ray| [0, 1, 2].map(|axis| sum[axis] + ray[axis]));
        let size = dot(sum, sum).sqrt();
        let axis = sum.map(|c| c / size);
        // All rays are as near to the axis as the corners, if these are less than a right angle away.
        let least = self.rays.iter().map(|&ray| dot(ray, axis)).fold(1.0, f64::min);
        let cosine = dot(direction, axis);
        // Not `<=`, so that a NaN bounds nothing.
        if !(least > 0.0 && cosine < least) {
            return 1.0;
        }
        cosine * least + ((1.0 - cosine * cosine) * (1.0 - least * least)).max(0.0).sqrt()
    }

    /// The part on the positive side of a plane through the apex.
    pub(super) fn cut(&self, normal: Point3) -> Cone {
        let mut rays = Vec::with_capacity(self.rays.len() + 1);
        for (i, &ray) in self.rays.iter().enumerate() {
            let next = self.rays[(i + 1) % self.rays.len()];
            let [own, other] = [ray, next].map(|ray| dot(ray, normal));
            if own >= 0.0 {
                rays.push(ray);
            }
            if (own >= 0.0) != (other >= 0.0) {
                let share = own / (own - other);
                let crossing = [0, 1, 2].map(|axis| ray[axis] + share * (next[axis] - ray[axis]));
                let size = dot(crossing, crossing).sqrt();
                rays.push(crossing.map(|c| c / size));
            }
        }
        Cone { rays }
    }

    /// Its solid angle, from triangles (Van Oosterom and Strackee, 1983).
    pub(super) fn solid_angle(&self) -> f64 {
        let Some((&first, rest)) = self.rays.split_first() else { return 0.0 };
        let triangle = |pair: &[Point3]| {
            let (p, q) = (pair[0], pair[1]);
            let denominator = 1.0 + dot(first, p) + dot(p, q) + dot(q, first);
            2.0 * dot(first, cross(p, q)).max(0.0).atan2(denominator)
        };
        rest.windows(2).map(triangle).sum()
    }
}

//! What the probe sweeps: cones over spherical polygons, and saddles along arcs, where it touches two balls.
//!
//! In a half-plane at the axis through both centres, the probe is a disk at the distance `rho` from the axis.
//! The layer next to the arc is the part of the disk in the triangle of the probe's centre and the centres of
//! the balls. If `rho` is less than the radius of the probe, the axis cuts it: the saddle has two cusps
//! there.

use crate::balls::shares::Measure;
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

/// The layer of thickness `probe` next to an arc of one radian, in the direction from the circle's middle to
/// one of the centres, and the saddle that bounds it. `height` is the signed distance of the middle from this
/// centre, `square` that of the circle's radius.
///
/// It is odd in the height: what lies behind the other centre is subtracted from its part.
pub(super) fn half_layer(height: f64, square: f64, probe: f64) -> Measure {
    let rho = square.sqrt();
    let end = height.abs().atan2(rho);
    // Below the angle of the cusp, the axis ends the layer.
    let cusp = if rho < probe { ((probe - rho) * (probe + rho)).sqrt().atan2(rho) } else { 0.0 };
    let cusp = cusp.min(end);
    let (angle, sine) = (end - cusp, end.sin() - cusp.sin());
    let area = probe * (rho * angle - probe * sine);
    let volume = probe * probe * (rho * angle / 2.0 - probe * sine / 3.0) + rho.powi(3) * cusp.tan() / 6.0;
    let sign = if height < 0.0 { -1.0 } else { 1.0 };
    Measure { area: sign * area, volume: sign * volume }
}

/// The same for both centres: what each has of it. Where the middle of the circle lies behind one of them,
/// the other has all.
pub(super) fn layer(heights: [f64; 2], square: f64, probe: f64) -> [Measure; 2] {
    let mut halves = heights.map(|height| half_layer(height, square, probe));
    for end in 0..2 {
        if heights[end] < 0.0 {
            let behind = std::mem::take(&mut halves[end]);
            halves[1 - end].add(1.0, behind);
        }
    }
    halves
}

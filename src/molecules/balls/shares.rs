//! Closed forms for what up to three balls have in common, and for the share of it in a tetrahedron of their
//! centres.

use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::vector::{cross, difference, dot};
use std::f64::consts::PI;

/// An area and a volume.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Measure {
    pub(super) area: f64,
    pub(super) volume: f64,
}

impl Measure {
    pub(super) fn add(&mut self, factor: f64, other: Measure) {
        self.area += factor * other.area;
        self.volume += factor * other.volume;
    }
}

pub(super) fn ball(radius: f64) -> Measure {
    Measure { area: 4.0 * PI * radius * radius, volume: 4.0 / 3.0 * PI * radius.powi(3) }
}

/// Distances of the plane of equal power from two centres, positive towards the other centre.
#[inline(always)]
pub(super) fn heights(distance: f64, radii: [f64; 2]) -> [f64; 2] {
    // The product of sum and difference: squares of nearly equal radii would cancel.
    let excess = (radii[0] - radii[1]) * (radii[0] + radii[1]);
    let first = 0.5 * (distance + excess / distance);
    [first, distance - first]
}

/// Surface and volume of the lens of two balls whose spheres meet.
pub(super) fn lens([p, q]: [Point3; 2], radii: [f64; 2]) -> Measure {
    let mut lens = Measure::default();
    for (radius, height) in radii.into_iter().zip(heights(length(difference(q, p)), radii)) {
        let cap = radius - height;
        lens.add(
            1.0,
            Measure { area: 2.0 * PI * radius * cap, volume: PI * cap * cap * (3.0 * radius - cap) / 3.0 },
        );
    }
    lens
}

/// Surface and volume of what three balls have in common, if their spheres meet in two points; else zero.
///
/// The tetrahedron of the centres and such a point lies in the union of the balls. So the shares of the balls
/// in it, less those of the lenses, plus half of the wanted, are its volume; and its surface in the union is
/// none.
pub(super) fn triple(centres: [Point3; 3], radii: [f64; 3]) -> Measure {
    let Some(meeting) = meeting_point(centres, radii) else { return Measure::default() };
    let mut half = Measure { area: 0.0, volume: volume([centres[0], centres[1], centres[2], meeting]) };
    for i in 0..3 {
        let [j, k] = [(i + 1) % 3, (i + 2) % 3];
        let angle = solid_angle(centres[i], [centres[j], centres[k], meeting]);
        half.add(-angle / (4.0 * PI), ball(radii[i]));
        let edge = dihedral([centres[i], centres[j]], [centres[k], meeting]);
        half.add(edge / (2.0 * PI), lens([centres[i], centres[j]], [radii[i], radii[j]]));
    }
    Measure { area: 2.0 * half.area, volume: 2.0 * half.volume }
}

/// A point of three spheres.
fn meeting_point(centres: [Point3; 3], radii: [f64; 3]) -> Option<Point3> {
    let foot = Foot::of(centres, radii)?;
    (foot.power < 0.0).then(|| foot.above(centres[0], 1.0))
}

/// The point of the plane of three centres that has the same power distance from all three balls.
pub(super) struct Foot {
    /// Relative to the first centre.
    pub(super) at: Point3,
    /// Right-handed about the way around the centres, of any length.
    pub(super) normal: Point3,
    pub(super) power: f64,
}

impl Foot {
    /// `None` if the centres are on a line.
    pub(super) fn of(centres: [Point3; 3], radii: [f64; 3]) -> Option<Foot> {
        let [b, c] = [1, 2].map(|i| difference(centres[i], centres[0]));
        let lift = |v: Point3, i: usize| 0.5 * (dot(v, v) + (radii[0] - radii[i]) * (radii[0] + radii[i]));
        let (over_b, over_c) = (lift(b, 1), lift(c, 2));
        let normal = cross(b, c);
        let square = dot(normal, normal);
        if square <= 0.0 {
            return None;
        }
        let first = (over_b * dot(c, c) - over_c * dot(b, c)) / square;
        let second = (over_c * dot(b, b) - over_b * dot(b, c)) / square;
        let at = [0, 1, 2].map(|axis| first * b[axis] + second * c[axis]);
        Some(Foot { at, normal, power: dot(at, at) - radii[0] * radii[0] })
    }

    /// The point of all three spheres on the side of the plane on which `other` is.
    pub(super) fn meeting(&self, first: Point3, other: Point3) -> Point3 {
        let is_above = dot(self.normal, difference(other, first)) >= 0.0;
        self.above(first, if is_above { 1.0 } else { -1.0 })
    }

    /// The point of all three spheres on the side of the normal, or for -1 on the other side.
    fn above(&self, first: Point3, side: f64) -> Point3 {
        let height = side * (-self.power / dot(self.normal, self.normal)).max(0.0).sqrt();
        [0, 1, 2].map(|axis| first[axis] + self.at[axis] + height * self.normal[axis])
    }
}

/// Volume of a tetrahedron.
pub(super) fn volume([a, b, c, d]: [Point3; 4]) -> f64 {
    dot(difference(b, a), cross(difference(c, a), difference(d, a))).abs() / 6.0
}

/// Solid angle of a tetrahedron at `apex` (Van Oosterom and Strackee, 1983).
pub(super) fn solid_angle(apex: Point3, others: [Point3; 3]) -> f64 {
    let [a, b, c] = others.map(|p| difference(p, apex));
    let [k, l, m] = [a, b, c].map(length);
    let denominator = k * l * m + dot(a, b) * m + dot(b, c) * k + dot(c, a) * l;
    2.0 * dot(a, cross(b, c)).abs().atan2(denominator)
}

/// Angle at an edge between the half-planes through two points.
pub(super) fn dihedral([p, q]: [Point3; 2], [a, b]: [Point3; 2]) -> f64 {
    let axis = difference(q, p);
    let (m, n) = (cross(axis, difference(a, p)), cross(axis, difference(b, p)));
    length(cross(m, n)).atan2(dot(m, n))
}

/// Angle of a triangle at `apex`.
pub(super) fn angle(apex: Point3, [a, b]: [Point3; 2]) -> f64 {
    let (a, b) = (difference(a, apex), difference(b, apex));
    length(cross(a, b)).atan2(dot(a, b))
}

/// Area that two disks in one plane have in common, if their circles meet.
pub(super) fn lens_of_disks([p, q]: [Point3; 2], radii: [f64; 2]) -> f64 {
    let segments = radii.into_iter().zip(heights(length(difference(q, p)), radii)).map(|(radius, height)| {
        let half_chord = ((radius - height) * (radius + height)).max(0.0).sqrt();
        radius * radius * half_chord.atan2(height) - height * half_chord
    });
    segments.sum()
}

/// Length of a vector.
pub(super) fn length(p: Point3) -> f64 {
    dot(p, p).sqrt()
}

//! Sphere equations, in rounded arithmetic.

use spmesh_delaunay::predicates::Point3;

#[inline(always)]
pub(super) fn difference(p: Point3, q: Point3) -> Point3 {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

#[inline(always)]
fn dot(p: Point3, q: Point3) -> f64 {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}

#[inline(always)]
fn cross(p: Point3, q: Point3) -> Point3 {
    [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
}

/// det(b - a, c - a, d - a): positive if the tetrahedron is positively oriented.
#[inline(always)]
pub(super) fn orientation(a: Point3, b: Point3, c: Point3, d: Point3) -> f64 {
    dot(difference(b, a), cross(difference(c, a), difference(d, a)))
}

/// The hyperplane through the lifted vertices of a tetrahedron: the tuple of thesis 3.4.2, for coordinates
/// relative to the first vertex. That vertex is on the sphere, so the constant of the tuple is zero and not
/// stored, and the high bits that the coordinates of neighbours share are subtracted off before anything is
/// rounded.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct Sphere {
    /// Coefficients of the coordinates.
    normal: Point3,
    /// Coefficient of the lift, negated: six times the volume, zero for the half-space of an infinite
    /// tetrahedron.
    pub(super) volume: f64,
}

impl Sphere {
    /// Of no tetrahedron yet.
    pub(super) const NONE: Sphere = Sphere { normal: [0.0; 3], volume: 0.0 };

    /// The sphere of a positively oriented tetrahedron.
    #[inline(always)]
    pub(super) fn through(o: Point3, a: Point3, b: Point3, c: Point3) -> Sphere {
        let (a, b, c) = (difference(a, o), difference(b, o), difference(c, o));
        let (bc, ca, ab) = (cross(b, c), cross(c, a), cross(a, b));
        let (k, l, m) = (dot(a, a), dot(b, b), dot(c, c));
        let normal = [0, 1, 2].map(|i| k * bc[i] + l * ca[i] + m * ab[i]);
        Sphere { normal, volume: dot(a, bc) }
    }

    /// The half-space of the points that see o, a, b clockwise: beyond a facet of the hull.
    #[inline(always)]
    pub(super) fn beyond(o: Point3, a: Point3, b: Point3) -> Sphere {
        Sphere { normal: cross(difference(a, o), difference(b, o)), volume: 0.0 }
    }

    /// Positive if `p` is inside, zero if it is on the sphere: the in-sphere determinant, if `o` is the first
    /// vertex.
    #[inline(always)]
    pub(super) fn value(&self, o: Point3, p: Point3) -> f64 {
        let d = difference(p, o);
        dot(self.normal, d) - self.volume * dot(d, d)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNER: [Point3; 4] = [[1.0, 1.0, 1.0], [3.0, 1.0, 1.0], [1.0, 3.0, 1.0], [1.0, 1.0, 3.0]];

    #[test]
    fn values_of_a_sphere() {
        let [o, a, b, c] = CORNER;
        let sphere = Sphere::through(o, a, b, c);
        assert_eq!(sphere.volume, orientation(o, a, b, c));
        assert_eq!(sphere.volume, 8.0);
        assert!(CORNER.iter().all(|&p| sphere.value(o, p) == 0.0));
        assert_eq!(sphere.value(o, [3.0, 3.0, 3.0]), 0.0);
        assert!(sphere.value(o, [2.0, 2.0, 2.0]) > 0.0);
        assert!(sphere.value(o, [0.0, 0.0, 0.0]) < 0.0);
    }

    #[test]
    fn values_of_a_half_space() {
        let [o, a, b, c] = CORNER;
        let half_space = Sphere::beyond(o, a, b);
        assert!(half_space.value(o, c) > 0.0);
        assert_eq!(half_space.value(o, [7.0, 5.0, 1.0]), 0.0);
        assert!(half_space.value(o, [1.0, 1.0, 0.0]) < 0.0);
    }
}

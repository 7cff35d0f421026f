//! Sphere equations, in rounded arithmetic.

use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::vector::{cross, difference, dot};

/// det(b - a, c - a, d - a): positive if the tetrahedron is positively oriented.
#[inline(always)]
pub fn orientation(a: Point3, b: Point3, c: Point3, d: Point3) -> f64 {
    dot(difference(b, a), cross(difference(c, a), difference(d, a)))
}

/// The hyperplane through the lifted vertices of a tetrahedron: the tuple of thesis 3.4.2, for coordinates
/// relative to the first vertex. That vertex is on the sphere, so the constant of the tuple is zero and not
/// stored, and the high bits that the coordinates of neighbours share are subtracted off before anything is
/// rounded.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub struct Sphere {
    /// Coefficients of the coordinates.
    normal: Point3,
    /// Coefficient of the lift, negated: six times the volume, zero for the half-space of an infinite
    /// tetrahedron.
    pub volume: f64,
}

impl Sphere {
    /// Of no tetrahedron yet.
    pub const NONE: Sphere = Sphere { normal: [0.0; 3], volume: 0.0 };

    /// The sphere of a positively oriented tetrahedron.
    #[inline(always)]
    pub fn through(o: Point3, a: Point3, b: Point3, c: Point3) -> Sphere {
        let (a, b, c) = (difference(a, o), difference(b, o), difference(c, o));
        let (bc, ca, ab) = (cross(b, c), cross(c, a), cross(a, b));
        let (k, l, m) = (dot(a, a), dot(b, b), dot(c, c));
        let normal = [0, 1, 2].map(|i| k * bc[i] + l * ca[i] + m * ab[i]);
        Sphere { normal, volume: dot(a, bc) }
    }

    /// The half-space of the points that see o, a, b clockwise: beyond a facet of the hull.
    #[inline(always)]
    pub fn beyond(o: Point3, a: Point3, b: Point3) -> Sphere {
        Sphere { normal: cross(difference(a, o), difference(b, o)), volume: 0.0 }
    }

    /// Positive if `p` is inside, zero if it is on the sphere: the in-sphere determinant, if `o` is the first
    /// vertex.
    #[inline(always)]
    pub fn value(&self, o: Point3, p: Point3) -> f64 {
        let d = difference(p, o);
        dot(self.normal, d) - self.volume * dot(d, d)
    }
}

//! Vectors of space in rounded arithmetic.

use crate::predicates::Point3;

/// p - q.
#[inline(always)]
pub fn difference(p: Point3, q: Point3) -> Point3 {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

/// The cross product.
#[inline(always)]
pub fn cross(p: Point3, q: Point3) -> Point3 {
    [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
}

/// The scalar product.
#[inline(always)]
pub fn dot(p: Point3, q: Point3) -> f64 {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}

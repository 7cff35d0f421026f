//! Vectors of space in rounded arithmetic.

use crate::predicates::Point3;

#[inline(always)]
pub(crate) fn difference(p: Point3, q: Point3) -> Point3 {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

#[inline(always)]
pub(crate) fn cross(p: Point3, q: Point3) -> Point3 {
    [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
}

#[inline(always)]
pub(crate) fn dot(p: Point3, q: Point3) -> f64 {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}

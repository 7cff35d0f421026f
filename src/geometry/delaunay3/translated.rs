//! Vertices as the new point sees them.

use super::complex::Complex;
use crate::predicates::{Point3, insphere_is_certain};
use spmesh_model::simplex::TETRAHEDRON_FACETS;

/// A vertex relative to the new point.
#[derive(Debug, Clone, Copy)]
pub(super) struct TranslatedVertex {
    /// Difference to the new point.
    pub(super) at: Point3,
    /// Square of the distance.
    pub(super) lift: f64,
}

impl TranslatedVertex {
    /// The vertex at infinity, lifted, is the direction upwards: (0, 0, 0; any positive number).
    #[inline(always)]
    pub(super) fn new(complex: &Complex, vertex: u32, from: Point3, infinite_lift: f64) -> TranslatedVertex {
        if vertex == complex.infinite() {
            return TranslatedVertex { at: [0.0; 3], lift: infinite_lift };
        }
        let at = difference(complex.point(vertex), from);
        TranslatedVertex { at, lift: dot(at, at) }
    }
}

#[inline(always)]
pub(super) fn difference(p: Point3, q: Point3) -> Point3 {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

#[inline(always)]
fn cross(p: Point3, q: Point3) -> Point3 {
    [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
}

#[inline(always)]
fn dot(p: Point3, q: Point3) -> f64 {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}

/// det(p, q, r).
#[inline(always)]
pub(super) fn volume(p: Point3, q: Point3, r: Point3) -> f64 {
    dot(p, cross(q, r))
}

/// The in-sphere determinant of a tetrahedron as the new point sees it.
pub(super) struct InSphere {
    pub(super) corners: [TranslatedVertex; 4],
    /// The volumes under its facets.
    pub(super) volumes: [f64; 4],
    /// Positive if the new point is in the sphere.
    pub(super) value: f64,
    /// The greatest of the lifts.
    pub(super) greatest: f64,
}

impl InSphere {
    #[inline(always)]
    pub(super) fn new(corners: [TranslatedVertex; 4]) -> InSphere {
        let volumes = TETRAHEDRON_FACETS.map(|[i, j, k]| volume(corners[i].at, corners[j].at, corners[k].at));
        let terms: [f64; 4] = std::array::from_fn(|i| corners[i].lift * volumes[i]);
        let value = (terms[0] + terms[1]) + (terms[2] + terms[3]);
        let greatest = corners.iter().fold(0.0, |g, corner| if corner.lift > g { corner.lift } else { g });
        InSphere { corners, volumes, value, greatest }
    }

    /// The sign of the value is that of the exact one.
    #[inline(always)]
    pub(super) fn is_certain(&self) -> bool {
        insphere_is_certain(self.value, self.greatest)
    }
}

//! Vertices in coordinates relative to the new point.

use super::complex::Complex;
use super::locate::Site;
use super::weights::Weights;
use crate::predicates::{Point3, insphere_is_certain, orient3d_is_certain, power_is_certain};
use crate::simplex::TETRAHEDRON_FACETS;
use crate::vector::{cross, difference, dot};

/// A vertex relative to the new point.
#[derive(Debug, Clone, Copy)]
pub(super) struct TranslatedVertex {
    /// Difference to the new point.
    pub(super) at: Point3,
    /// Square of the distance, less what its weight exceeds that of the new point.
    pub(super) lift: f64,
}

impl TranslatedVertex {
    /// The vertex at infinity, lifted, is the direction upwards: (0, 0, 0; any positive number).
    #[inline(always)]
    pub(super) fn new<W: Weights>(
        complex: &Complex<'_>,
        weights: &W,
        vertex: u32,
        from: Site,
        infinite_lift: f64,
    ) -> TranslatedVertex {
        if vertex == complex.infinite() {
            return TranslatedVertex { at: [0.0; 3], lift: infinite_lift };
        }
        let at = difference(complex.point(vertex), from.at);
        let square = dot(at, at);
        let lift = if W::ARE_EQUAL { square } else { square - (weights.of(vertex) - from.weight) };
        TranslatedVertex { at, lift }
    }

    /// The greatest magnitude of the square of the distance and the lift.
    #[inline(always)]
    pub(super) fn greatest<W: Weights>(&self) -> f64 {
        if W::ARE_EQUAL { self.lift } else { dot(self.at, self.at).max(self.lift.abs()) }
    }
}

/// det(p, q, r).
#[inline(always)]
pub(super) fn volume(p: Point3, q: Point3, r: Point3) -> f64 {
    dot(p, cross(q, r))
}

/// The in-sphere determinant of a tetrahedron and the new point.
pub(super) struct InSphere {
    pub(super) corners: [TranslatedVertex; 4],
    /// The volumes under its facets.
    pub(super) volumes: [f64; 4],
    /// Positive if the new point is in the sphere.
    pub(super) value: f64,
    /// The greatest magnitude of the lifts, and of the squares of distances.
    pub(super) greatest: f64,
}

impl InSphere {
    #[inline(always)]
    pub(super) fn new<W: Weights>(corners: [TranslatedVertex; 4]) -> InSphere {
        // Closures would not be inlined into functions for one kind of processor.
        let (mut volumes, mut terms, mut greatest) = ([0.0; 4], [0.0; 4], 0.0);
        for (side, [i, j, k]) in TETRAHEDRON_FACETS.into_iter().enumerate() {
            volumes[side] = volume(corners[i].at, corners[j].at, corners[k].at);
            terms[side] = corners[side].lift * volumes[side];
            let reach = corners[side].greatest::<W>();
            greatest = if reach > greatest { reach } else { greatest };
        }
        let value = (terms[0] + terms[1]) + (terms[2] + terms[3]);
        InSphere { corners, volumes, value, greatest }
    }

    /// The sign of the value is that of the exact one.
    #[inline(always)]
    pub(super) fn is_certain<W: Weights>(&self) -> bool {
        if W::ARE_EQUAL {
            insphere_is_certain(self.value, self.greatest)
        } else {
            power_is_certain(self.value, self.greatest)
        }
    }

    /// The new point is certainly inside of the tetrahedron.
    #[inline(always)]
    pub(super) fn has_origin_inside(&self) -> bool {
        let cube = self.greatest * self.greatest * self.greatest;
        self.volumes.iter().all(|&volume| volume > 0.0 && orient3d_is_certain(volume, cube))
    }
}

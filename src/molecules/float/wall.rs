//! The facets around a cavity.

use super::mesh::{Facet, faraway_corner};
use super::sphere::Sphere;

/// A facet around a cavity, as the new tetrahedron on it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wall {
    /// The tetrahedron in the cavity.
    pub(super) inside: u32,
    /// The facet, from outside of the cavity.
    pub(super) outside: Facet,
    /// The new point, and the corners of the facet.
    pub(super) vertices: [u32; 4],
    pub(super) sphere: Sphere,
}

impl Wall {
    /// Whether the new point sees the inner side of the facet.
    #[inline(always)]
    pub(super) fn is_seen(&self) -> bool {
        self.sphere.volume > 0.0 || faraway_corner(&self.vertices).is_some()
    }
}

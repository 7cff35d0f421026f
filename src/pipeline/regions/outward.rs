//! Directions out of the hull of a sample.

use super::diagram::{Diagram, ROUNDING};
use spmesh_delaunay::predicates::Point3;

/// The direction that is perpendicular to a facet of the hull, and how far off its components may be.
pub(super) struct Outward {
    pub(super) normal: Point3,
    pub(super) error: Point3,
    /// A point of the facet.
    pub(super) from: Point3,
}

impl Outward {
    pub(super) fn of(diagram: &Diagram, cell: u32) -> Outward {
        // Facets are counterclockwise as seen from outside.
        let vertices = diagram.cells[cell as usize].vertices;
        let [a, b, c] = [0, 1, 2].map(|corner| diagram.points[vertices[corner] as usize]);
        let [u, v]: [Point3; 2] = [b, c].map(|p| std::array::from_fn(|axis| p[axis] - a[axis]));
        let terms = PLANES.map(|(i, j)| (u[i] * v[j], u[j] * v[i]));
        let is_zero = |(i, j): (usize, usize)| (u[i] == 0.0 || v[j] == 0.0) && (u[j] == 0.0 || v[i] == 0.0);
        let error = std::array::from_fn(|axis| {
            let ((left, right), factors) = (terms[axis], PLANES[axis]);
            // Products that are not zero may underflow.
            let least = if is_zero(factors) { 0.0 } else { f64::MIN_POSITIVE };
            ROUNDING * (left.abs() + right.abs()) + least
        });
        Outward { normal: terms.map(|(left, right)| left - right), error, from: a }
    }
}

/// The two axes that are perpendicular to each.
const PLANES: [(usize, usize); 3] = [(1, 2), (2, 0), (0, 1)];

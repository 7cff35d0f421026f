//! The walk of queries: from a triangle to the one that contains a target.

use super::triangles::{Corner, Triangle};
use super::triangulation::Triangulation;
use crate::predicates::{FiniteFloatPredicates, Point2, Predicates2, Sign, lexicographic};

/// Where a walk ends.
pub(super) enum Arrival {
    /// In this triangle, closed: the sides of its edges that the target lies on, none of them negative. Entry
    /// `i` is for the edge opposite to corner `i`.
    Inside(u32, [Sign; 3]),
    /// At the hull: the target lies strictly beyond an edge of this triangle.
    Outside(u32),
}

impl Triangulation {
    /// Walks from triangle `start`, or from the last one if there are fewer, towards `target`, exactly. `None`
    /// if there are no triangles or the target is not finite.
    ///
    /// Cost: a step for each triangle between; O(sqrt n) steps for points that are spread evenly.
    pub(super) fn walk(
        &self,
        target: Point2,
        start: u32,
        predicates: &mut FiniteFloatPredicates,
    ) -> Option<Arrival> {
        let triangles = self.triangles.triangles();
        if !target.iter().all(|coordinate| coordinate.is_finite()) {
            return None;
        }
        let mut number = start.min(triangles.len().checked_sub(1)? as u32);
        // The side across which the walk has come: the target is known to be on the inner side of it.
        let mut entered = None;
        // In a Delaunay triangulation this walk meets no triangle twice.
        loop {
            let triangle = &triangles[number as usize];
            let corners = self.places(triangle);
            let mut signs = [Sign::Positive; 3];
            let mut exit = None;
            for side in (0..3).filter(|&side| Some(side) != entered) {
                signs[side] = predicates.orient2d(corners[(side + 1) % 3], corners[(side + 2) % 3], target);
                if signs[side] == Sign::Negative {
                    exit = Some(side);
                    break;
                }
            }
            let Some(exit) = exit else { return Some(Arrival::Inside(number, signs)) };
            let Some(Corner { triangle, corner }) = triangle.neighbour(exit) else {
                return Some(Arrival::Outside(number));
            };
            (number, entered) = (triangle, Some(corner as usize));
        }
    }

    /// Where the corners of a triangle are.
    #[inline(always)]
    pub(super) fn places(&self, triangle: &Triangle) -> [Point2; 3] {
        triangle.vertices.map(|v| self.points[v as usize])
    }

    /// The vertex at `target` if there are no triangles: the vertices are in lexicographic order then.
    pub(super) fn vertex_on_line(&self, target: Point2) -> Option<u32> {
        let is_answer = self.triangles.triangles().is_empty() && target.iter().all(|c| c.is_finite());
        is_answer.then(|| self.place_on_line(target).ok()).flatten().map(|place| self.triangles.hull[place])
    }

    /// The place of the vertex at `target` in the hull of a triangulation without triangles, or where it would
    /// be.
    pub(super) fn place_on_line(&self, target: Point2) -> Result<usize, usize> {
        self.triangles.hull.binary_search_by(|&v| lexicographic(self.points[v as usize], target))
    }
}

/// The corner at which the target lies, if it lies at one: the other two signs are zero.
pub(super) fn corner_at(signs: [Sign; 3]) -> Option<usize> {
    (0..3).find(|&corner| signs[(corner + 1) % 3] == Sign::Zero && signs[(corner + 2) % 3] == Sign::Zero)
}

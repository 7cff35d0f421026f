//! What is around a vertex, and around a triangle.

use super::triangulation::Triangulation;
use crate::predicates::{Point2, circumcentre2};

impl Triangulation {
    /// The vertices that share an edge with vertex `v`, counterclockwise; on the hull from the next vertex of
    /// the hull to the one before. None for duplicates, and none without triangles.
    ///
    /// # Panics
    /// If there is no such point.
    pub fn star(&self, v: u32) -> impl Iterator<Item = u32> + '_ {
        let triangles = self.triangles.triangles();
        self.triangles.corners_of(v).flat_map(move |at| {
            let triangle = &triangles[at.triangle as usize];
            let [first, second] = [1, 2].map(|turn| (at.corner as usize + turn) % 3);
            // Only the last triangle on the hull has nothing after its second vertex.
            let last = triangle.neighbour(first).is_none().then_some(triangle.vertices[second]);
            [Some(triangle.vertices[first]), last].into_iter().flatten()
        })
    }

    /// The centre of the circle through the corners of triangle `number`: off by at most 1e-12 of the radius
    /// and one unit in the last place of each coordinate. `None` if it overflows.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn circumcentre(&self, number: u32) -> Option<Point2> {
        circumcentre2(self.places(&self.triangles.triangles()[number as usize]))
    }
}

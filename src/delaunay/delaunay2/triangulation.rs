//! A triangulation that answers questions.

use super::nearby::Nearby;
use super::triangles::{Corner, Triangles};
use crate::location::Location;
use crate::predicates::{FiniteFloatPredicates, Point2, Predicates2, Sign, lexicographic};
use std::ops::Deref;

/// A Delaunay triangulation with its points. All vertices are indices of the input points.
///
/// [`Tetrahedralization`](crate::delaunay3::Tetrahedralization) has the same methods in space. The arrays of
/// the kernel are at hand too, by way of [`Deref`].
#[derive(Debug, Clone, Default)]
pub struct Triangulation {
    pub(super) points: Vec<Point2>,
    pub(super) triangles: Triangles,
    /// For insertion alone.
    pub(super) nearby: Nearby,
}

impl Deref for Triangulation {
    type Target = Triangles;

    fn deref(&self) -> &Triangles {
        &self.triangles
    }
}

impl Triangulation {
    /// The `triangles` of `points`.
    pub(super) fn new(points: Vec<Point2>, triangles: Triangles) -> Triangulation {
        Triangulation { points, triangles, nearby: Nearby::default() }
    }

    /// The input points, duplicates included.
    pub fn points(&self) -> &[Point2] {
        &self.points
    }

    /// The triangles by their vertices, counterclockwise. Their numbers are those of
    /// [`Triangulation::neighbours`].
    pub fn simplices(&self) -> impl ExactSizeIterator<Item = [u32; 3]> + '_ {
        self.triangles.triangles().iter().map(|triangle| triangle.vertices)
    }

    /// The triangles across the edges opposite to the three vertices of triangle `number`; `None` at the
    /// hull.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn neighbours(&self, number: u32) -> [Option<u32>; 3] {
        let triangle = &self.triangles.triangles()[number as usize];
        [0, 1, 2].map(|side| triangle.neighbour(side).map(|corner| corner.triangle))
    }

    /// The edges of all triangles, each once with its lesser vertex first, in increasing order.
    ///
    /// Cost: a sort.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        let sides = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]];
        let mut edges: Vec<[u32; 2]> =
            self.simplices().flat_map(sides).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// The edges of the hull, counterclockwise; none if there are no triangles.
    pub fn hull(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let vertices = &self.triangles.hull;
        let count = if self.triangles.triangles().is_empty() { 0 } else { vertices.len() };
        (0..count).map(move |i| [vertices[i], vertices[(i + 1) % count]])
    }

    /// For each point the vertex that stands for it: the equal point of least index.
    pub fn representatives(&self) -> Vec<u32> {
        let mut representatives: Vec<u32> = (0..self.points.len() as u32).collect();
        self.triangles
            .duplicates
            .iter()
            .for_each(|&[point, vertex]| representatives[point as usize] = vertex);
        representatives
    }

    /// Where `target` lies: exactly. A target with a coordinate that is not finite is outside.
    ///
    /// If there are no triangles, every target that is no vertex is outside.
    ///
    /// Cost: a walk of O(sqrt n) triangles for points that are spread evenly.
    pub fn locate(&self, target: Point2) -> Location {
        if !target.iter().all(|coordinate| coordinate.is_finite()) {
            return Location::Outside;
        }
        let triangles = self.triangles.triangles();
        if triangles.is_empty() {
            return self.locate_on_line(target);
        }
        let mut predicates = FiniteFloatPredicates::default();
        let mut number = 0;
        // In a Delaunay triangulation this walk meets no triangle twice.
        loop {
            let triangle = &triangles[number as usize];
            let [a, b, c] = triangle.vertices;
            let signs = [[b, c], [c, a], [a, b]]
                .map(|[u, v]| predicates.orient2d(self.points[u as usize], self.points[v as usize], target));
            let Some(side) = signs.iter().position(|&sign| sign == Sign::Negative) else {
                return Location::in_simplex(number, triangle.vertices, signs);
            };
            match triangle.neighbour(side) {
                Some(Corner { triangle, .. }) => number = triangle,
                None => return Location::Outside,
            }
        }
    }

    /// Without triangles, the vertices are in lexicographic order.
    fn locate_on_line(&self, target: Point2) -> Location {
        let vertices = &self.triangles.hull;
        let found = vertices.binary_search_by(|&v| lexicographic(self.points[v as usize], target));
        found.map_or(Location::Outside, |place| Location::Vertex(vertices[place]))
    }
}

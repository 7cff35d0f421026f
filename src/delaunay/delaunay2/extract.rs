//! From the triangulated sphere to a [`super::Triangles`], in place: infinite triangles go, and vertices
//! become indices of input points.

use super::half_edge::{HalfEdge, NONE, number_of, previous, triangle_of};
use super::mesh::Mesh;

/// Reads the finished sphere.
pub(super) struct Extraction<'a> {
    pub(super) mesh: Mesh<'a>,
    /// Input index of each vertex.
    pub(super) indices: &'a [u32],
    /// For each vertex, a triangle at it; overwritten.
    pub(super) triangle_at: &'a mut Vec<u32>,
    /// The arrays of the triangulation, empty.
    pub(super) hull: &'a mut Vec<u32>,
    pub(super) triangle_of_vertex: &'a mut Vec<u32>,
}

impl Extraction<'_> {
    /// Leaves the finite triangles at the start of the array, fills the other arrays, and returns the number
    /// of triangles; `points` is the number of input points, duplicates included.
    pub(super) fn run(mut self, points: usize) -> usize {
        let hull_sides = self.hull_sides();
        // Half-edges of the hull, by origin.
        let mut hull: Vec<(u32, HalfEdge)> = hull_sides
            .iter()
            .map(|&side| (self.mesh.opposite(previous(side)), self.mesh.neighbour(side)))
            .collect();
        hull.iter().for_each(|&(_, inside)| self.mesh.set_neighbour(inside, NONE));
        let count = self.fill_holes(&hull_sides, &mut hull);
        self.rename_vertices(count);
        for &(origin, inside) in &hull {
            // The first triangle counterclockwise.
            self.triangle_at[origin as usize] = number_of(inside);
            self.hull.push(self.indices[origin as usize]);
        }
        self.triangle_of_vertex.clear();
        self.triangle_of_vertex.reserve_exact(points);
        self.triangle_of_vertex.resize(points, NONE);
        for (&index, &triangle) in self.indices.iter().zip(self.triangle_at.iter()).skip(1) {
            self.triangle_of_vertex[index as usize] = triangle;
        }
        count
    }

    /// The outer half-edges of the edges of the hull, counterclockwise.
    fn hull_sides(&self) -> Vec<HalfEdge> {
        let blank = self.mesh.blank();
        let mut triangles = Mesh::triangles(self.mesh.len()).filter(|t| !blank.contains(t));
        let mut sides = Vec::new();
        let Some(first) = triangles.find_map(|t| self.mesh.hull_side(t)) else { return sides };
        let mut side = first;
        loop {
            sides.push(side);
            // From outside an edge is seen clockwise: the next one is across the edge from its end to
            // infinity.
            side = previous(self.mesh.neighbour(previous(side)));
            if side == first {
                return sides;
            }
        }
    }

    /// Moves the last finite triangles to the places of infinite and blank ones; the number of finite ones.
    fn fill_holes(&mut self, hull_sides: &[HalfEdge], hull: &mut [(u32, HalfEdge)]) -> usize {
        let infinite = hull_sides.iter().map(|&side| triangle_of(side));
        let mut holes: Vec<HalfEdge> = infinite.chain(self.mesh.blank()).collect();
        holes.sort_unstable();
        let count = self.mesh.len() - holes.len();
        let tail = Mesh::triangles(self.mesh.len()).skip(count);
        let moved: Vec<HalfEdge> = tail.filter(|t| holes.binary_search(t).is_err()).collect();
        for (&t, &hole) in moved.iter().zip(&holes) {
            self.mesh.move_triangle(t, hole);
        }
        for (_, inside) in hull {
            if let Ok(at) = moved.binary_search(&triangle_of(*inside)) {
                *inside = holes[at] + (*inside - moved[at]);
            }
        }
        count
    }

    /// Makes vertices indices of input points, and notes a triangle for each.
    fn rename_vertices(&mut self, count: usize) {
        self.triangle_at.clear();
        self.triangle_at.reserve_exact(self.indices.len());
        self.triangle_at.resize(self.indices.len(), NONE);
        for t in Mesh::triangles(count) {
            let vertices = self.mesh.vertices(t);
            vertices.iter().for_each(|&v| self.triangle_at[v as usize] = number_of(t));
            self.mesh.set_vertices(t, vertices.map(|v| self.indices[v as usize]));
        }
    }
}

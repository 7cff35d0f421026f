//! The nearest vertices of a target.

use super::stars::TetrahedraAround;
use super::tetrahedralization::Tetrahedralization;
use crate::nearest::{Graph, Search, nearest_of_all};
use crate::points::is_finite;
use crate::predicates::{Extent, FiniteFloatPredicates3, Point3};
use crate::starts::Starts;
use crate::walk::walk;

/// A vertex of the mesh in a tetrahedron.
#[derive(Debug, Clone, Copy)]
pub(super) struct VertexIn {
    pub(super) vertex: u32,
    pub(super) tetrahedron: u32,
}

/// The mesh with buffers.
struct Edges<'m> {
    mesh: &'m Tetrahedralization,
    around: TetrahedraAround,
}

impl Graph<3> for Edges<'_> {
    type Node = VertexIn;

    fn point(&self, node: VertexIn) -> Point3 {
        self.mesh.vertices[node.vertex as usize].at
    }

    fn index(&self, node: VertexIn) -> u32 {
        self.mesh.vertices[node.vertex as usize].index
    }

    fn find_neighbours(&mut self, node: VertexIn, neighbours: &mut Vec<VertexIn>) {
        self.around.find_vertices(self.mesh, node, neighbours);
    }
}

impl Tetrahedralization {
    /// The vertex nearest to the target, exactly: that of least index, if several are. The target may be
    /// outside of the hull. `None` if there are no points or the target is not finite.
    ///
    /// Domain: without weights.
    ///
    /// Cost: a walk of O(cbrt n) tetrahedra for points that are spread evenly; without tetrahedra, O(n).
    pub fn nearest(&self, target: Point3) -> Option<u32> {
        self.nearest_from(target, 0)
    }

    /// The same, found from tetrahedron `start`: fast if it is near, such as the one that [`Starts`] find.
    /// Any number will do.
    pub fn nearest_from(&self, target: Point3, start: u32) -> Option<u32> {
        match self.first_vertex(target, start) {
            Some(first) => Some(Search::new(&mut self.along_edges(), target).nearest(first)),
            None => self.nearest_of_flat(target, 1).first().copied(),
        }
    }

    /// The `count` vertices nearest to the target, or all if there are fewer: exactly, by distance, then by
    /// index. None if the target is not finite.
    ///
    /// Domain: without weights.
    ///
    /// Cost: that of [`Tetrahedralization::nearest`], and O(log k) for each of the k vertices and their
    /// neighbours.
    pub fn k_nearest(&self, target: Point3, count: usize) -> Vec<u32> {
        self.k_nearest_from(target, count, 0)
    }

    /// The same, found from tetrahedron `start`.
    pub fn k_nearest_from(&self, target: Point3, count: usize, start: u32) -> Vec<u32> {
        match self.first_vertex(target, start) {
            Some(first) => Search::new(&mut self.along_edges(), target).k_nearest(first, count),
            None => self.nearest_of_flat(target, count),
        }
    }

    /// Tetrahedra to begin walks at, for targets in no order, found with the first question.
    ///
    /// Cost: a sort of about as many as points.
    pub fn starts(&self) -> &Starts<3> {
        self.starts.get_or_init(|| self.find_starts())
    }

    fn find_starts(&self) -> Starts<3> {
        let at = |vertex: u32| self.vertices[vertex as usize].at;
        let extent = Extent::of_each(self.vertices.iter().map(|vertex| vertex.at));
        let corner = |number: u32| at(self.tetrahedra[number as usize].vertices[0]);
        Starts::new(self.tetrahedra.len(), &extent, corner)
    }

    fn along_edges(&self) -> Edges<'_> {
        Edges { mesh: self, around: TetrahedraAround::default() }
    }

    /// A vertex of the tetrahedron where the walk to the target ends, if there are tetrahedra.
    fn first_vertex(&self, target: Point3, start: u32) -> Option<VertexIn> {
        let arrival = walk(self, start, target, &mut FiniteFloatPredicates3::default())?;
        let tetrahedron = arrival.simplex();
        Some(VertexIn { vertex: self.tetrahedra[tetrahedron as usize].vertices[0], tetrahedron })
    }

    /// Without tetrahedra.
    fn nearest_of_flat(&self, target: Point3, count: usize) -> Vec<u32> {
        if !is_finite(&target) {
            return Vec::new();
        }
        nearest_of_all(self.vertices.iter().map(|vertex| (vertex.at, vertex.index)), target, count)
    }
}

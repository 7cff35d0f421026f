//! From half-edges to the arrays of a [`Triangulation`].

use super::edges::{Edges, NIL, OUTER};
use super::merge::Hull;
use super::triangulation::{NONE, Triangulation};
use crate::huge_pages;
use crate::predicates::{Point2, lexicographic};

/// Reads the finished half-edges. Vertices of half-edges are positions in Morton order.
pub(super) struct Extraction<'a, 'e> {
    pub(super) points: &'a [Point2],
    /// Input index of each point.
    pub(super) indices: &'a [u32],
    pub(super) edges: &'a mut Edges<'e>,
    /// For each point, a triangle at it; overwritten.
    pub(super) triangle_at: &'a mut Vec<u32>,
}

impl Extraction<'_, '_> {
    /// Fills the empty `out`; `count` is the number of input points, duplicates included.
    pub(super) fn run(mut self, hull: Hull, count: usize, out: &mut Triangulation) {
        huge_pages::reserve(&mut out.triangle_of_vertex, count);
        out.triangle_of_vertex.resize(count, NONE);
        let hull_edges = if hull.start == NIL { Vec::new() } else { self.walk_hull(hull.start) };
        // Around collinear points the walk passes all but the first and the last twice.
        if self.points.len() < 3 || hull_edges.len() > self.points.len() {
            out.hull.extend(0..self.points.len() as u32);
            out.hull
                .sort_unstable_by(|&u, &v| lexicographic(self.points[u as usize], self.points[v as usize]));
            out.hull.iter_mut().for_each(|v| *v = self.indices[*v as usize]);
            return;
        }
        self.emit_triangles(hull_edges.len(), out);
        self.emit_neighbours(out);
        for &e in &hull_edges {
            let v = self.edges.origin(e) as usize;
            out.hull.push(self.indices[v]);
            // The first triangle counterclockwise.
            self.triangle_at[v] = self.edges.corner(e) / 3;
        }
        for (&index, &triangle) in self.indices.iter().zip(self.triangle_at.iter()) {
            out.triangle_of_vertex[index as usize] = triangle;
        }
    }

    /// The half-edges of the hull, counterclockwise. Their twins become those of no triangle.
    fn walk_hull(&mut self, start: u32) -> Vec<u32> {
        let mut hull = Vec::new();
        let mut e = start;
        loop {
            hull.push(e);
            let next = self.edges.hull_next(e);
            self.edges.exclude(e ^ 1);
            e = next;
            if e == start {
                return hull;
            }
        }
    }

    /// Emits each triangle at the first of its half-edges, and numbers its corners.
    ///
    /// Half-edges lie in memory as the recursion made them: what is close in the plane is close here. Which is the
    /// first can be told without a look at the others, so that one iteration need not wait for another.
    fn emit_triangles(&mut self, hull: usize, out: &mut Triangulation) {
        let count = 2 * self.points.len() - 2 - hull;
        huge_pages::reserve(&mut out.triangles, count);
        huge_pages::reserve(self.triangle_at, self.points.len());
        self.triangle_at.resize(self.points.len(), NONE);
        for e in 0..self.edges.half_edges().len() as u32 {
            let (second, third) = self.edges.left_face(e);
            if e < second && e < third {
                let triangle = out.triangles.len() as u32;
                let vertices = [self.edges.origin(e), self.edges.destination(e), self.edges.origin(third)];
                self.edges.set_corner(second, 3 * triangle);
                self.edges.set_corner(third, 3 * triangle + 1);
                self.edges.set_corner(e, 3 * triangle + 2);
                vertices.iter().for_each(|&v| self.triangle_at[v as usize] = triangle);
                out.triangles.push(vertices.map(|v| self.indices[v as usize]));
            }
        }
        debug_assert_eq!(out.triangles.len(), count);
    }

    /// Links triangles across their sides.
    fn emit_neighbours(&mut self, out: &mut Triangulation) {
        huge_pages::reserve(&mut out.neighbours, out.triangles.len());
        out.neighbours.resize(out.triangles.len(), [NONE; 3]);
        let across = out.neighbours.as_flattened_mut();
        let (pairs, _) = self.edges.half_edges().as_chunks::<2>();
        for [one, two] in pairs {
            if one.corner != OUTER && two.corner != OUTER {
                across[one.corner as usize] = two.corner / 3;
                across[two.corner as usize] = one.corner / 3;
            }
        }
    }
}

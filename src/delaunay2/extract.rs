//! From the triangulated sphere to the arrays of a [`Triangulation`].

use super::sphere::{HalfEdge, INFINITE, Sphere, previous, triangle_of};
use super::triangulation::{NONE, Triangulation};
use crate::huge_pages;

/// Reads the finished sphere.
pub(super) struct Extraction<'a> {
    pub(super) sphere: Sphere<'a>,
    /// Input index of each vertex.
    pub(super) indices: &'a [u32],
    /// For each vertex, a triangle at it; overwritten.
    pub(super) triangle_at: &'a mut Vec<u32>,
}

impl Extraction<'_> {
    /// Fills the empty `out`; `count` is the number of input points, duplicates included.
    pub(super) fn run(mut self, count: usize, out: &mut Triangulation) {
        let (triangles, hull_side) = self.number_triangles();
        self.emit_triangles(triangles, out);
        huge_pages::reserve(&mut out.triangle_of_vertex, count);
        out.triangle_of_vertex.resize(count, NONE);
        for (&index, &triangle) in self.indices.iter().zip(self.triangle_at.iter()).skip(1) {
            out.triangle_of_vertex[index as usize] = triangle;
        }
        self.walk_hull(hull_side, out);
    }

    /// Numbers the finite triangles; the others get [`NONE`].
    ///
    /// Returns how many are finite, and the outer half-edge of an edge of the hull.
    fn number_triangles(&mut self) -> (u32, HalfEdge) {
        let (mut number, mut infinite) = (0, 0);
        for t in self.sphere.triangles() {
            let [a, b, c] = self.sphere.vertices(t);
            let is_finite = a != INFINITE && b != INFINITE && c != INFINITE;
            self.sphere.set_number(t, if is_finite { number } else { NONE });
            number += u32::from(is_finite);
            if !is_finite && a.max(b).max(c) != INFINITE {
                infinite = t;
            }
        }
        (number, self.sphere.hull_side(infinite).unwrap_or(infinite))
    }

    /// Writes the finite triangles, and notes one for each vertex.
    fn emit_triangles(&mut self, count: u32, out: &mut Triangulation) {
        huge_pages::reserve(&mut out.triangles, count as usize);
        huge_pages::reserve(&mut out.neighbours, count as usize);
        huge_pages::reserve(self.triangle_at, self.indices.len());
        self.triangle_at.resize(self.indices.len(), NONE);
        for t in self.sphere.triangles() {
            let number = self.sphere.number(t);
            if number == NONE {
                continue;
            }
            let vertices = self.sphere.vertices(t);
            let beyond = |h| self.sphere.number(triangle_of(self.sphere.across(h)));
            out.triangles.push(vertices.map(|v| self.indices[v as usize]));
            out.neighbours.push([beyond(t), beyond(t + 1), beyond(t + 2)]);
            vertices.iter().for_each(|&v| self.triangle_at[v as usize] = number);
        }
    }

    /// Lists the hull, and makes the triangle at each of its vertices the first one counterclockwise.
    fn walk_hull(&mut self, hull_side: HalfEdge, out: &mut Triangulation) {
        let mut side = hull_side;
        loop {
            // From outside the edge is seen clockwise.
            let origin = self.indices[self.sphere.opposite(previous(side)) as usize];
            out.hull.push(origin);
            let inside = triangle_of(self.sphere.across(side));
            out.triangle_of_vertex[origin as usize] = self.sphere.number(inside);
            // Across the edge from the end of this one to infinity is the next one.
            side = previous(self.sphere.across(previous(side)));
            if side == hull_side {
                break;
            }
        }
    }
}

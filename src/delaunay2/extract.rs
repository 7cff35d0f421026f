//! From the triangulated sphere to the arrays of a [`Triangulation`].

use super::sphere::{HalfEdge, Sphere, previous, triangle, triangle_of};
use super::triangulation::{NONE, Triangulation};
use crate::huge_pages;

/// Reads the finished sphere.
pub(super) struct Extraction<'a> {
    pub(super) sphere: Sphere<'a>,
    /// The end of its triangles.
    pub(super) end: HalfEdge,
    /// Input index of each vertex.
    pub(super) indices: &'a [u32],
    /// For each vertex, a number; overwritten.
    pub(super) numbers: &'a mut Vec<u32>,
}

impl Extraction<'_> {
    /// Fills the empty `out`; `count` is the number of input points, duplicates included.
    pub(super) fn run(mut self, count: usize, out: &mut Triangulation) {
        let Some(hull_side) = self.number_triangles() else { return };
        self.emit_triangles(out);
        huge_pages::reserve(&mut out.triangle_of_vertex, count);
        out.triangle_of_vertex.resize(count, NONE);
        for (&index, &triangle) in self.indices.iter().zip(self.numbers.iter()).skip(1) {
            out.triangle_of_vertex[index as usize] = triangle;
        }
        self.walk_hull(hull_side, out);
    }

    fn triangles(&self) -> impl Iterator<Item = HalfEdge> + use<> {
        (0..self.end).step_by(triangle(1) as usize)
    }

    /// Numbers the finite triangles in the order of their least vertex; infinite ones get [`NONE`].
    ///
    /// Returns the outer half-edge of an edge of the hull.
    fn number_triangles(&mut self) -> Option<HalfEdge> {
        huge_pages::reserve(self.numbers, self.indices.len());
        self.numbers.resize(self.indices.len(), 0);
        let least = |sphere: &Sphere, t| {
            let [a, b, c] = sphere.vertices(t);
            a.min(b).min(c) as usize
        };
        for t in self.triangles() {
            self.numbers[least(&self.sphere, t)] += 1;
        }
        self.numbers[0] = 0;
        let mut number = 0;
        for count in self.numbers.iter_mut() {
            number += std::mem::replace(count, number);
        }
        let mut hull_side = None;
        for t in self.triangles() {
            let vertex = least(&self.sphere, t);
            if vertex == 0 {
                self.sphere.set_number(t, NONE);
                hull_side = self.sphere.hull_side(t);
            } else {
                self.sphere.set_number(t, self.numbers[vertex]);
                self.numbers[vertex] += 1;
            }
        }
        hull_side
    }

    /// Writes each triangle at its number, and notes one for each vertex.
    fn emit_triangles(&mut self, out: &mut Triangulation) {
        let count = self.numbers.last().copied().unwrap_or_default() as usize;
        huge_pages::reserve(&mut out.triangles, count);
        huge_pages::reserve(&mut out.neighbours, count);
        out.triangles.resize(count, [NONE; 3]);
        out.neighbours.resize(count, [NONE; 3]);
        for t in self.triangles() {
            let number = self.sphere.number(t);
            if number == NONE {
                continue;
            }
            let vertices = self.sphere.vertices(t);
            out.triangles[number as usize] = vertices.map(|v| self.indices[v as usize]);
            let beyond = |h| self.sphere.number(triangle_of(self.sphere.across(h)));
            out.neighbours[number as usize] = [beyond(t), beyond(t + 1), beyond(t + 2)];
            vertices.iter().for_each(|&v| self.numbers[v as usize] = number);
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

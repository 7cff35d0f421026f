//! From half-edges to the arrays of a [`Triangulation`].

use super::edges::{Edges, HalfEdge, NIL, OUTER, UNNUMBERED};
use super::merge::Hull;
use super::triangulation::{NONE, Triangulation};
use crate::predicates::{Point2, lexicographic};

/// Reads the finished half-edges. Vertices of half-edges are positions in Morton order.
pub(super) struct Extraction<'a> {
    pub(super) points: &'a [Point2],
    /// Input index of each point.
    pub(super) indices: &'a [u32],
    pub(super) edges: &'a mut Edges,
    /// For each point, a half-edge that leaves it; overwritten.
    pub(super) leaving: &'a mut Vec<u32>,
}

impl Extraction<'_> {
    /// Fills the empty `out`; `count` is the number of input points, duplicates included.
    pub(super) fn run(mut self, hull: Hull, count: usize, out: &mut Triangulation) {
        out.triangle_of_vertex.resize(count, NONE);
        // Every bounded face is a triangle, so a tree has none: all points are on one line.
        if self.edges.live_pairs() < self.points.len().max(1) {
            out.hull.extend(0..self.points.len() as u32);
            out.hull
                .sort_unstable_by(|&u, &v| lexicographic(self.points[u as usize], self.points[v as usize]));
            out.hull.iter_mut().for_each(|v| *v = self.indices[*v as usize]);
            return;
        }
        self.find_leaving();
        self.walk_hull(hull.start, out);
        self.emit_triangles(out);
        self.emit_neighbours(out);
    }

    fn find_leaving(&mut self) {
        self.leaving.clear();
        self.leaving.resize(self.points.len(), NIL);
        for (e, half) in (0u32..).zip(self.edges.half_edges()) {
            if half.destination != NIL {
                self.leaving[half.destination as usize] = e ^ 1;
            }
        }
    }

    /// Lists the hull, marks its outer side, and makes each hull vertex start at its first edge.
    fn walk_hull(&mut self, start: u32, out: &mut Triangulation) {
        let mut e = start;
        loop {
            let v = self.edges.origin(e) as usize;
            out.hull.push(self.indices[v]);
            self.leaving[v] = e;
            self.edges.set_corner(e ^ 1, OUTER);
            e = self.edges.hull_next(e);
            if e == start {
                break;
            }
        }
    }

    /// Emits each triangle at the first of its vertices, and numbers its corners.
    fn emit_triangles(&mut self, out: &mut Triangulation) {
        let count = 2 * self.points.len() - 2 - out.hull.len();
        out.triangles.reserve(count);
        for v in 0..self.points.len() as u32 {
            let first = self.leaving[v as usize];
            let mut e = first;
            loop {
                let HalfEdge { destination: a, onext, corner, .. } = self.edges.half_edge(e);
                if corner == UNNUMBERED {
                    let corner = 3 * out.triangles.len() as u32;
                    let b = self.edges.destination(onext);
                    out.triangles.push([v, a, b].map(|v| self.indices[v as usize]));
                    self.edges.set_corner(self.edges.oprev(e ^ 1), corner);
                    self.edges.set_corner(onext ^ 1, corner + 1);
                    self.edges.set_corner(e, corner + 2);
                }
                e = onext;
                if e == first {
                    break;
                }
            }
            out.triangle_of_vertex[self.indices[v as usize] as usize] =
                self.edges.half_edge(first).corner / 3;
        }
        debug_assert_eq!(out.triangles.len(), count);
    }

    /// Links triangles across their sides: a pass over the edges in the order they are stored, without a branch that
    /// is hard to predict.
    fn emit_neighbours(&mut self, out: &mut Triangulation) {
        out.neighbours.resize(out.triangles.len(), [NONE; 3]);
        let across = out.neighbours.as_flattened_mut();
        let (pairs, _) = self.edges.half_edges().as_chunks::<2>();
        for [one, two] in pairs.iter().filter(|pair| pair[0].destination != NIL) {
            if one.corner != OUTER && two.corner != OUTER {
                across[one.corner as usize] = two.corner / 3;
                across[two.corner as usize] = one.corner / 3;
            }
        }
    }
}

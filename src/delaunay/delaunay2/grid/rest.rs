//! What is not covered: triangulated by insertion, cut out and joined to the rest.

use super::cover::Cover;
use crate::delaunay2::Triangles;
use crate::delaunay2::half_edge::{HalfEdge, NEIGHBOURS, NONE, WORDS, number_of};
use crate::predicates::Point2;

/// The number of a triangle that is cut off.
const CUT: u32 = u32::MAX - 1;

/// The points that are not surrounded by covered triangles.
#[derive(Debug, Default)]
pub(super) struct Rest {
    /// Their nodes.
    nodes: Vec<u32>,
    pub(super) points: Vec<Point2>,
    /// Their triangulation.
    pub(super) triangles: Triangles,
    /// For each of its triangles, its number in the whole triangulation, or [`CUT`].
    numbers: Vec<u32>,
    /// Triangles whose neighbours have not been looked at.
    stack: Vec<u32>,
}

impl Rest {
    pub(super) fn collect(&mut self, cover: &Cover, points: &[Point2]) {
        self.nodes.clear();
        self.nodes.extend(cover.inner().filter(|&node| cover.is_open(node)).map(|node| node as u32));
        self.points.clear();
        self.points.extend(self.nodes.iter().map(|&node| points[cover.points[node as usize] as usize]));
    }

    /// Writes the triangles that are not covered after the `covered` ones, joins them to these, and returns
    /// the number of all.
    pub(super) fn write(
        &mut self,
        cover: &Cover,
        covered: u32,
        words: &mut [u32],
        triangle_of_vertex: &mut [u32],
        hull: &mut Vec<u32>,
    ) -> usize {
        self.cut(cover);
        let mut count = covered;
        for number in self.numbers.iter_mut().filter(|number| **number != CUT) {
            *number = count;
            count += 1;
        }
        let point = |v: u32| cover.points[self.nodes[v as usize] as usize];
        for (triangle, &number) in self.triangles.triangles().iter().zip(&self.numbers) {
            if number == CUT {
                continue;
            }
            let vertices = triangle.vertices;
            let mut neighbours = [NONE; 3];
            for side in 0..3 {
                let beyond = self.half_edge(cover, [vertices[(side + 2) % 3], vertices[(side + 1) % 3]]);
                if beyond != NONE {
                    words[(beyond + NEIGHBOURS) as usize] = number * WORDS as u32 + side as u32;
                    neighbours[side] = beyond;
                } else if let Some(corner) = triangle.neighbour(side) {
                    neighbours[side] = self.numbers[corner.triangle as usize] * WORDS as u32 + corner.corner;
                }
            }
            let [a, b, c] = vertices.map(point);
            let [i, j, k] = neighbours;
            words[number as usize * WORDS..][..WORDS].copy_from_slice(&[a, b, c, 0, i, j, k, 0]);
            for vertex in [a, b, c] {
                triangle_of_vertex[vertex as usize] = number;
            }
        }
        let corners = &self.triangles.hull;
        for (place, &v) in corners.iter().enumerate() {
            let then = corners[(place + 1) % corners.len()];
            // The first triangle counterclockwise.
            triangle_of_vertex[point(v) as usize] = match self.half_edge(cover, [v, then]) {
                NONE => self.numbers[self.triangles.triangle_of_vertex[v as usize] as usize],
                inside => number_of(inside),
            };
            hull.push(point(v));
        }
        count as usize
    }

    /// Marks the triangles that lie in what is covered: those at an edge with a covered triangle on the same
    /// side, and their neighbours across edges that are none of covered triangles.
    fn cut(&mut self, cover: &Cover) {
        let count = self.triangles.triangles().len();
        self.numbers.clear();
        self.numbers.resize(count, 0);
        self.stack.clear();
        for t in 0..count {
            let [a, b, c] = self.triangles.triangles()[t].vertices;
            if [[a, b], [b, c], [c, a]].into_iter().any(|edge| self.half_edge(cover, edge) != NONE) {
                self.numbers[t] = CUT;
                self.stack.push(t as u32);
            }
        }
        while let Some(t) = self.stack.pop() {
            let triangle = self.triangles.triangles()[t as usize];
            for side in 0..3 {
                let ends = [triangle.vertices[(side + 1) % 3], triangle.vertices[(side + 2) % 3]];
                let Some(beyond) = triangle.neighbour(side) else { continue };
                if self.numbers[beyond.triangle as usize] != CUT && self.half_edge(cover, ends) == NONE {
                    self.numbers[beyond.triangle as usize] = CUT;
                    self.stack.push(beyond.triangle);
                }
            }
        }
    }

    /// The half-edge from one of the points to another in a covered triangle, or `NONE`.
    fn half_edge(&self, cover: &Cover, ends: [u32; 2]) -> HalfEdge {
        let [u, v] = ends.map(|end| self.nodes[end as usize] as usize);
        cover.half_edge(u, v)
    }
}

//! The triangles in conflict with a new point, and the star that takes their place, in finished arrays.
//!
//! Here the plane ends at the hull: there are no infinite triangles as in the kernel.

use crate::delaunay2::half_edge::{HalfEdge, NONE, WORDS, corner, next, number_of, previous};
use crate::delaunay2::triangles::{Triangle, Triangles};
use crate::predicates::{FiniteFloatPredicates, Point2, Predicates2, Sign};

/// An edge as the new point sees it: counterclockwise.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    pub(super) from: u32,
    pub(super) to: u32,
    /// The half-edge on the other side; [`NONE`] at the hull.
    pub(super) across: HalfEdge,
}

impl Edge {
    /// The edge of a half-edge, seen from its triangle.
    pub(super) fn of(triangles: &[Triangle], h: HalfEdge) -> Edge {
        let Triangle { vertices, neighbours, .. } = triangles[number_of(h) as usize];
        let [from, to] = [next(h), previous(h)].map(|h| vertices[corner(h)]);
        Edge { from, to, across: neighbours[corner(h)] }
    }
}

/// The triangles in conflict with a point.
#[derive(Debug, Default)]
pub(super) struct Cavity {
    triangles: Vec<u32>,
    /// The edges around them, counterclockwise; each begins where the one before ends.
    border: Vec<Edge>,
}

impl Cavity {
    /// The conflicts of a point at `at`, found from edges of the known part, which are in counterclockwise
    /// order from the last one to the first. `inside` is the triangle that they are of, if there is one.
    ///
    /// The triangles form a tree, because no vertex lies inside: none is met twice.
    pub(super) fn open(
        triangles: &[Triangle],
        points: &[Point2],
        at: Point2,
        inside: Option<u32>,
        mut edges: Vec<Edge>,
        predicates: &mut FiniteFloatPredicates,
    ) -> Cavity {
        let mut cavity = Cavity { triangles: Vec::from_iter(inside), border: Vec::new() };
        while let Some(edge) = edges.pop() {
            let beyond = triangles.get(number_of(edge.across) as usize);
            let is_in_conflict = beyond.is_some_and(|triangle| {
                let [a, b, c] = triangle.vertices.map(|v| points[v as usize]);
                predicates.incircle_perturbed(a, b, c, at) == Sign::Positive
            });
            if is_in_conflict {
                cavity.triangles.push(number_of(edge.across));
                edges.extend([previous(edge.across), next(edge.across)].map(|h| Edge::of(triangles, h)));
            } else {
                cavity.border.push(edge);
            }
        }
        cavity
    }

    /// No triangles: the vertex is to see these edges.
    pub(super) fn of_border(border: Vec<Edge>) -> Cavity {
        Cavity { triangles: Vec::new(), border }
    }

    /// Replaces the triangles by a star around vertex `q`. It is closed unless `q` is on the hull: then the
    /// hull goes from the end of the border to `q`, and on to its start.
    pub(super) fn fill(self, mesh: &mut Triangles, q: u32, is_closed: bool) {
        let Cavity { triangles: mut numbers, border } = self;
        let before = mesh.triangles().len();
        let most = before + border.len() - numbers.len();
        numbers.extend(before as u32..most as u32);
        let triangles = mesh.memory.resize(most);
        let (first, last) = (0, border.len() - 1);
        let word = |place: usize, corner: u32| numbers[place] * WORDS as u32 + corner;
        for (place, edge) in border.iter().enumerate() {
            let ahead = if place == last { is_closed.then_some(first) } else { Some(place + 1) };
            let behind = if place == first { is_closed.then_some(last) } else { Some(place - 1) };
            let [ahead, behind] =
                [(ahead, 1), (behind, 0)].map(|(at, corner)| at.map_or(NONE, |at| word(at, corner)));
            triangles[numbers[place] as usize] =
                Triangle::new([edge.from, edge.to, q], [ahead, behind, edge.across]);
            if edge.across != NONE {
                triangles[number_of(edge.across) as usize].neighbours[corner(edge.across)] = word(place, 2);
            }
        }
        name_triangles(mesh, &numbers, &border);
        // The first triangle counterclockwise, where the hull begins and ends.
        mesh.triangle_of_vertex[q as usize] = numbers[first];
        if !is_closed {
            mesh.triangle_of_vertex[border[last].to as usize] = numbers[last];
        }
    }
}

/// Gives the vertices of the border, each the start of an edge, a triangle that they are in.
///
/// A vertex of the hull must have the first one counterclockwise, the one beside the edge of the hull that
/// starts there. If that one went, its edge is now one of the border.
fn name_triangles(mesh: &mut Triangles, numbers: &[u32], border: &[Edge]) {
    for (&number, edge) in numbers.iter().zip(border) {
        let old = mesh.triangle_of_vertex[edge.from as usize];
        let is_in_old =
            mesh.triangles().get(old as usize).is_some_and(|triangle| triangle.vertices.contains(&edge.from));
        if edge.across == NONE || !is_in_old {
            mesh.triangle_of_vertex[edge.from as usize] = number;
        }
    }
}

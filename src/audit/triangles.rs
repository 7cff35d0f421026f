//! The part of the audit that whole and partial triangle meshes share: what can be proved triangle by
//! triangle, with the vertices that are live.

use std::cmp::Ordering;

use super::check::{Check, Ledger, Violation};
use super::constraints::Constraints;
use super::corner::{self, name_corners};
use super::exact::plane::{in_circle, in_raised_circle, orientation};
use super::facets::{Meeting, OpenFacets};
use super::vertices::{Vertex, Vertices};
use super::winding::{Winding, corner_of};
use spmesh_stream::Patch;

/// A vertex of a triangle.
pub(super) type Corner = corner::Corner<2>;

/// Directed edges whose twin has not come yet, with the third corner of their triangle.
pub(super) type OpenEdges = OpenFacets<2, Corner>;

/// The standard for the edges of a triangulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standard {
    /// Interior edges are locally Delaunay.
    Delaunay,
    /// Interior edges are locally Delaunay, and ties are resolved canonically, so that the triangulation is
    /// unique.
    Canonical,
}

/// The triangles around a vertex.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Fans {
    /// Numbers of open edges that start at the vertex, and that end there.
    pub(super) leaving: u32,
    pub(super) entering: u32,
    /// Whether a triangle has the vertex.
    pub(super) is_used: bool,
    pub(super) winding: Winding,
}

/// Live vertices and open edges of the triangles seen so far.
pub(super) struct Triangles {
    standard: Standard,
    pub(super) vertices: Vertices<Fans>,
    pub(super) edges: OpenEdges,
    pub(super) triangles: u64,
    /// Segments, if the mesh is constrained.
    pub(super) constraints: Option<Box<Constraints>>,
}

impl Triangles {
    pub(super) fn new(standard: Standard) -> Self {
        Triangles {
            standard,
            vertices: Vertices::default(),
            edges: OpenFacets::new(),
            triangles: 0,
            constraints: None,
        }
    }

    /// Checks a patch and gives the vertices that it finalizes to `finalize`.
    pub(super) fn patch(
        &mut self,
        patch: &Patch,
        ledger: &mut Ledger,
        mut finalize: impl FnMut(&Vertex<Fans>, &mut Ledger) -> Result<(), Violation>,
    ) -> Result<(), Violation> {
        self.vertices.enter(patch, ledger)?;
        let mut sides = patch.sides.iter().peekable();
        for (number, triangle) in (0..).zip(patch.triangles()) {
            let mut segments = [None; 3];
            while let Some(&[_, place, segment]) = sides.next_if(|side| side[0] == number) {
                segments[place as usize] = Some(segment);
            }
            self.triangle(triangle.map(|local| local as usize), segments, ledger)?;
        }
        if let Some(constraints) = &mut self.constraints {
            patch.finalized.iter().for_each(|&local| constraints.forget(patch.id(local)));
        }
        self.vertices.leave(patch, |vertex| finalize(vertex, ledger))
    }

    /// Checks a triangle. `segments` are those that the sides opposite to its corners are on.
    fn triangle(
        &mut self,
        locals: [usize; 3],
        segments: [Option<u32>; 3],
        ledger: &mut Ledger,
    ) -> Result<(), Violation> {
        let corners = locals.map(|local| Corner::of(&self.vertices.local[local]));
        let [a, b, c] = corners;
        let turn = orientation(a.at, b.at, c.at);
        ledger.count(Check::Orientation, turn.exactly);
        if turn.sign != Ordering::Greater {
            let fault = if turn.sign == Ordering::Less { "is clockwise" } else { "is flat" };
            let message = format!("triangle ({}, {}, {}) {fault}", a.id, b.id, c.id);
            return Err(name_corners(Violation::new(Check::Orientation, message), &corners));
        }
        self.triangles += 1;
        self.wind(locals, corners);
        for side in 0..3 {
            self.side([0, 1, 2].map(|i| locals[(side + i) % 3]), segments[(side + 2) % 3], ledger)?;
        }
        Ok(())
    }

    /// Counts the triangle for the corner that has it below or above: the middle one from left to right.
    fn wind(&mut self, locals: [usize; 3], [a, b, c]: [Corner; 3]) {
        let faces_down = |p: Corner, q: Corner| p.at < q.at;
        if let Some((corner, place)) = corner_of([faces_down(b, c), faces_down(c, a), faces_down(a, b)]) {
            self.vertices.local[locals[corner]].star.winding.add(place);
        }
    }

    /// Meets the edge from the first to the second corner, which is on a segment or none, with its twin.
    fn side(
        &mut self,
        locals: [usize; 3],
        segment: Option<u32>,
        ledger: &mut Ledger,
    ) -> Result<(), Violation> {
        let local = &mut self.vertices.local;
        let [a, b, c] = locals.map(|vertex| Corner::of(&local[vertex]));
        let (from, to) = (locals[0], locals[1]);
        local[from].star.is_used = true;
        ledger.add(Check::Edges, 1);
        match self.edges.meet([a.id, b.id], c) {
            Meeting::Open => {
                local[from].star.leaving += 1;
                local[to].star.entering += 1;
                match &mut self.constraints {
                    Some(constraints) => constraints.first([a, b], segment, ledger),
                    None => Ok(()),
                }
            }
            Meeting::Twin(opposite) => {
                local[from].star.entering -= 1;
                local[to].star.leaving -= 1;
                if let Some(constraints) = &mut self.constraints
                    && constraints.second([a, b], segment)?
                {
                    return Ok(());
                }
                self.interior_edge(a, b, c, opposite, ledger)
            }
            Meeting::Twice(other) => {
                let message = format!(
                    "edge {} to {} belongs to the triangles with {} and with {}",
                    a.id, b.id, other.id, c.id
                );
                Err(name_corners(Violation::new(Check::Edges, message), &[a, b, other, c]))
            }
        }
    }

    /// Proves that `opposite` lies outside of the circle of `a`, `b`, `c`, on the other side of the edge.
    fn interior_edge(
        &self,
        a: Corner,
        b: Corner,
        c: Corner,
        opposite: Corner,
        ledger: &mut Ledger,
    ) -> Result<(), Violation> {
        let place = in_circle(a.at, b.at, c.at, opposite.at);
        let delaunay = if self.constraints.is_some() { Check::ConstrainedDelaunay } else { Check::Delaunay };
        ledger.count(delaunay, place.exactly);
        let (check, fault) = match place.sign {
            Ordering::Less => return Ok(()),
            Ordering::Greater => (delaunay, "is not locally Delaunay"),
            Ordering::Equal if self.standard == Standard::Delaunay => return Ok(()),
            Ordering::Equal => {
                ledger.count(Check::Canonical, true);
                if in_raised_circle(a.at, b.at, c.at, opposite.at) == Ordering::Less {
                    return Ok(());
                }
                (Check::Canonical, "between cocircular points is not the canonical one")
            }
        };
        let message = format!(
            "edge {} to {} {fault}: vertex {} and the triangle ({}, {}, {})",
            a.id, b.id, opposite.id, a.id, b.id, c.id
        );
        Err(name_corners(Violation::new(check, message), &[a, b, c, opposite]))
    }
}

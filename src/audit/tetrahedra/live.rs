//! What can be proved tetrahedron by tetrahedron, with the vertices that are live.

use std::cmp::Ordering;

use super::Corner;
use super::faces::OpenEdges;
use super::hidden::Hidden;
use crate::Standard;
use crate::check::{Check, Ledger, Violation};
use crate::corner::{name_corners, named};
use crate::exact::power::{in_orthosphere, in_raised_orthosphere};
use crate::exact::space::{faces_ahead, orientation};
use crate::facets::{Meeting, OpenFacets};
use crate::vertices::{Vertex, Vertices};
use crate::winding::{Winding, corner_of};
use spmesh_stream::{Patch, Weights};

/// The corners of each facet of a positive tetrahedron, counterclockwise seen from outside; the facet
/// opposite to corner 0 first.
pub(super) const FACETS: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// The edges of a tetrahedron. Edges at the same distance from the two ends of the list are opposite to each
/// other; the facets at an edge are opposite to the corners of the opposite edge.
pub(super) const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// The tetrahedra around a vertex: the size of its link so far.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Star {
    /// Tetrahedra that have the vertex.
    pub(super) tetrahedra: u64,
    /// Edges that have it.
    pub(super) edges: u64,
    /// Open facets that have it.
    pub(super) open: u64,
    pub(super) winding: Winding,
}

/// Live vertices, open facets and their edges of the tetrahedra seen so far.
pub(crate) struct LiveTetrahedra {
    standard: Standard,
    /// If the mesh has weights, where they are and what they hide.
    pub(super) weighted: Option<(Weights, Hidden)>,
    pub(super) vertices: Vertices<Star>,
    pub(super) facets: OpenFacets<3, Corner>,
    edges: OpenEdges,
    facets_seen: u64,
    tetrahedra_seen: u64,
}

/// Counts so far.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    pub(super) vertices: u64,
    pub(super) edges: u64,
    /// Facets, twins counted once.
    pub(super) facets: u64,
    pub(super) tetrahedra: u64,
}

impl LiveTetrahedra {
    pub(super) fn new(standard: Standard) -> Self {
        LiveTetrahedra {
            standard,
            weighted: None,
            vertices: Vertices::default(),
            facets: OpenFacets::new(),
            edges: OpenEdges::default(),
            facets_seen: 0,
            tetrahedra_seen: 0,
        }
    }

    pub(super) fn seen(&self) -> Seen {
        Seen {
            vertices: self.vertices.seen(),
            edges: self.edges.seen(),
            facets: self.facets_seen,
            tetrahedra: self.tetrahedra_seen,
        }
    }

    /// Checks a patch, whose new vertices have `rows`, and gives the vertices that it finalizes to
    /// `finalize`.
    pub(super) fn patch(
        &mut self,
        patch: &Patch,
        rows: &[u8],
        ledger: &mut Ledger,
        mut finalize: impl FnMut(&Vertex<Star>, &mut Ledger) -> Result<(), Violation>,
    ) -> Result<(), Violation> {
        self.vertices.enter(patch, ledger)?;
        if let Some((weights, _)) = &self.weighted {
            self.vertices.weigh(weights.read(rows));
        }
        for tetrahedron in patch.tetrahedra() {
            self.tetrahedron(tetrahedron.map(|local| local as usize), ledger)?;
        }
        self.vertices.leave(patch, |vertex| finalize(vertex, ledger))
    }

    fn tetrahedron(&mut self, locals: [usize; 4], ledger: &mut Ledger) -> Result<(), Violation> {
        let corners = locals.map(|local| Corner::of(&self.vertices.local[local]));
        let [a, b, c, d] = corners;
        let turn = orientation(a.at, b.at, c.at, d.at);
        ledger.count(Check::Orientation, turn.exactly);
        if turn.sign != Ordering::Greater {
            let fault = if turn.sign == Ordering::Less { "is inverted" } else { "is flat" };
            let message = format!("tetrahedron {} {fault}", named(&corners));
            return Err(name_corners(Violation::new(Check::Orientation, message), &corners));
        }
        self.tetrahedra_seen += 1;
        if let Some((_, hidden)) = &mut self.weighted {
            hidden.tetrahedron(&corners, self.standard, ledger)?;
        }
        let mut is_shared = [false; 4];
        for (side, is_shared) in is_shared.iter_mut().enumerate() {
            *is_shared = self.side(&corners, &locals, side, ledger)?;
        }
        for (ends, sides) in EDGES.into_iter().zip(EDGES.into_iter().rev()) {
            self.edge(ends.map(|i| (corners[i].id, locals[i])), sides.map(|side| is_shared[side]));
        }
        self.wind(&corners, &locals);
        locals.iter().for_each(|&local| self.vertices.local[local].star.tetrahedra += 1);
        Ok(())
    }

    /// Updates the edge between two vertices, given by their ids and local indices. `is_shared` tells for
    /// each of the tetrahedron's two facets at the edge whether its twin was there. If one twin was there,
    /// the edge is not new; if only one was, the edge has as many open facets as before.
    fn edge(&mut self, [p, q]: [(u64, usize); 2], is_shared: [bool; 2]) {
        let ids = edge(p.0, q.0);
        match is_shared {
            [false, false] => {
                if self.edges.open_two(ids) {
                    self.vertices.local[p.1].star.edges += 1;
                    self.vertices.local[q.1].star.edges += 1;
                }
            }
            [true, true] => self.edges.close_two(ids),
            [false, true] | [true, false] => {}
        }
    }

    /// Counts the tetrahedron for the corner that has it ahead or behind, if one has.
    fn wind(&mut self, corners: &[Corner; 4], locals: &[usize; 4]) {
        let is_facing = FACETS.map(|facet| {
            let [a, b, c] = facet.map(|i| corners[i].at);
            faces_ahead(a, b, c)
        });
        if let Some((corner, place)) = corner_of(is_facing) {
            self.vertices.local[locals[corner]].star.winding.add(place);
        }
    }

    /// Meets the facet opposite to a corner with its twin; whether the twin was there.
    fn side(
        &mut self,
        corners: &[Corner; 4],
        locals: &[usize; 4],
        side: usize,
        ledger: &mut Ledger,
    ) -> Result<bool, Violation> {
        let facet = FACETS[side];
        ledger.add(Check::Facets, 1);
        match self.facets.meet(facet.map(|i| corners[i].id), corners[side]) {
            Meeting::Open => {
                self.facets_seen += 1;
                facet.iter().for_each(|&i| self.vertices.local[locals[i]].star.open += 1);
                Ok(false)
            }
            Meeting::Twin(opposite) => {
                facet.iter().for_each(|&i| self.vertices.local[locals[i]].star.open -= 1);
                self.interior_facet(corners, side, opposite, ledger).map(|()| true)
            }
            Meeting::Twice(other) => {
                let [a, b, c] = facet.map(|i| corners[i]);
                let message = format!(
                    "facet {} belongs to the tetrahedra with {} and with {}, both on the same side",
                    named(&[a, b, c]),
                    other.id,
                    corners[side].id
                );
                let violation = Violation::new(Check::Facets, message);
                Err(name_corners(violation, &[a, b, c, other, corners[side]]))
            }
        }
    }

    /// Proves that `opposite`, on the other side of the facet opposite to corner `side`, lies outside of the
    /// sphere.
    fn interior_facet(
        &self,
        corners: &[Corner; 4],
        side: usize,
        opposite: Corner,
        ledger: &mut Ledger,
    ) -> Result<(), Violation> {
        let (four, fifth) = (corners.map(Corner::weighted), opposite.weighted());
        let place = in_orthosphere(four, fifth);
        ledger.count(Check::Delaunay, place.exactly);
        let (check, fault) = match place.sign {
            Ordering::Less => return Ok(()),
            Ordering::Greater => (Check::Delaunay, "is not locally Delaunay"),
            Ordering::Equal if self.standard == Standard::Delaunay => return Ok(()),
            Ordering::Equal => {
                ledger.count(Check::Canonical, true);
                if in_raised_orthosphere(four, fifth) == Ordering::Less {
                    return Ok(());
                }
                (Check::Canonical, "between cospherical points is not the canonical one")
            }
        };
        let [p, q, r] = FACETS[side].map(|i| corners[i]);
        let message = format!(
            "facet {} {fault}: vertex {} and the tetrahedron {}",
            named(&[p, q, r]),
            opposite.id,
            named(corners)
        );
        let violation = name_corners(Violation::new(check, message), corners);
        Err(name_corners(violation, &[opposite]))
    }
}

/// The ids of an edge in increasing order.
pub(super) fn edge(p: u64, q: u64) -> [u64; 2] {
    [p.min(q), p.max(q)]
}

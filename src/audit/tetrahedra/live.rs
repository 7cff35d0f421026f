//! What can be proved tetrahedron by tetrahedron, with the vertices that are live.

use std::cmp::Ordering;

use super::faces::SeenFaces;
use super::facets::{Corner, FACETS, Meeting, OpenFacets, name_corners};
use super::vertices::{Vertex, Vertices};
use crate::audit::Standard;
use crate::audit::check::{Check, Ledger, Violation};
use crate::audit::exact::space::{in_raised_sphere, in_sphere, orientation};
use crate::stream::Patch;

/// The edges of a tetrahedron.
pub(super) const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// Live vertices, open facets and edges of the tetrahedra seen so far.
pub(in crate::audit) struct LiveTetrahedra {
    standard: Standard,
    pub(super) vertices: Vertices,
    pub(super) facets: OpenFacets<Corner>,
    edges: SeenFaces<2>,
    facets_seen: u64,
    tetrahedra_seen: u64,
}

/// How much came so far.
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
            vertices: Vertices::default(),
            facets: OpenFacets::new(),
            edges: SeenFaces::default(),
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

    /// Checks a patch and gives the vertices that it finalizes to `finalize`.
    pub(super) fn patch(
        &mut self,
        patch: &Patch,
        ledger: &mut Ledger,
        mut finalize: impl FnMut(&Vertex, &mut Ledger) -> Result<(), Violation>,
    ) -> Result<(), Violation> {
        self.vertices.enter(patch)?;
        ledger.add(Check::Finalization, patch.vertices() as u64);
        for tetrahedron in patch.tetrahedra() {
            self.tetrahedron(tetrahedron.map(|local| local as usize), ledger)?;
        }
        self.vertices.leave(patch, |vertex| finalize(vertex, ledger))?;
        self.edges.sweep(|id| self.vertices.is_live(id));
        Ok(())
    }

    fn tetrahedron(&mut self, locals: [usize; 4], ledger: &mut Ledger) -> Result<(), Violation> {
        let corners = locals.map(|local| self.vertices.local[local].corner());
        let [a, b, c, d] = corners;
        let turn = orientation(a.at, b.at, c.at, d.at);
        ledger.count(Check::Orientation, turn.exactly);
        if turn.sign != Ordering::Greater {
            let fault = if turn.sign == Ordering::Less { "is inverted" } else { "is flat" };
            let message = format!("tetrahedron {} {fault}", named(&corners));
            return Err(name_corners(Violation::new(Check::Orientation, message), &corners));
        }
        self.tetrahedra_seen += 1;
        let mut is_shared = [false; 4];
        for (side, is_shared) in is_shared.iter_mut().enumerate() {
            *is_shared = self.side(&corners, &locals, side, ledger)?;
        }
        for [i, j] in EDGES {
            // The edges of a facet that was open came with the tetrahedron beyond it.
            let is_old = (0..4).any(|side| is_shared[side] && side != i && side != j);
            if !is_old && self.edges.add(edge(corners[i], corners[j])) {
                self.vertices.local[locals[i]].edges += 1;
                self.vertices.local[locals[j]].edges += 1;
            }
        }
        locals.iter().for_each(|&local| self.vertices.local[local].tetrahedra += 1);
        Ok(())
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
                facet.iter().for_each(|&i| self.vertices.local[locals[i]].open += 1);
                Ok(false)
            }
            Meeting::Twin(opposite) => {
                facet.iter().for_each(|&i| self.vertices.local[locals[i]].open -= 1);
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

    /// Proves that `opposite`, on the other side of the facet opposite to corner `side`, lies outside of the sphere.
    fn interior_facet(
        &self,
        corners: &[Corner; 4],
        side: usize,
        opposite: Corner,
        ledger: &mut Ledger,
    ) -> Result<(), Violation> {
        let [a, b, c, d] = corners.map(|corner| corner.at);
        let place = in_sphere(a, b, c, d, opposite.at);
        ledger.count(Check::Delaunay, place.exactly);
        let (check, fault) = match place.sign {
            Ordering::Less => return Ok(()),
            Ordering::Greater => (Check::Delaunay, "is not locally Delaunay"),
            Ordering::Equal if self.standard == Standard::Delaunay => return Ok(()),
            Ordering::Equal => {
                ledger.count(Check::Canonical, true);
                if in_raised_sphere(a, b, c, d, opposite.at) == Ordering::Less {
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
pub(super) fn edge(p: Corner, q: Corner) -> [u64; 2] {
    [p.id.min(q.id), p.id.max(q.id)]
}

/// The ids, as they are written in messages.
pub(super) fn named(corners: &[Corner]) -> String {
    let ids: Vec<String> = corners.iter().map(|corner| corner.id.to_string()).collect();
    format!("({})", ids.join(", "))
}

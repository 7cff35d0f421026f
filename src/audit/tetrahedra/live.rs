//! What can be proved tetrahedron by tetrahedron, with the vertices that are live.

use std::cmp::Ordering;
use std::collections::HashMap;

use foldhash::fast::RandomState;

use super::edges::LiveEdges;
use super::facets::{Corner, FACETS, Meeting, OpenFacets, name_corners};
use crate::audit::Standard;
use crate::audit::check::{Check, Ledger, Violation};
use crate::audit::exact::space::{in_raised_sphere, in_sphere, orientation};
use crate::bounds::Point;
use crate::stream::Patch;

/// A vertex between its patch and its finalization, with the size of its link.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vertex {
    pub(super) id: u64,
    pub(super) at: Point,
    /// Tetrahedra that have it.
    pub(super) tetrahedra: u64,
    /// Edges that have it.
    pub(super) edges: u64,
    /// Open facets that have it.
    pub(super) open: u64,
}

impl Vertex {
    pub(super) fn corner(&self) -> Corner {
        Corner { id: self.id, at: self.at }
    }
}

/// The edges of a tetrahedron.
const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// Live vertices, open facets and edges of the tetrahedra seen so far.
pub(super) struct LiveTetrahedra {
    standard: Standard,
    live: HashMap<u64, Vertex, RandomState>,
    pub(super) facets: OpenFacets,
    edges: LiveEdges,
    pub(super) seen: Seen,
    local: Vec<Vertex>,
    live_max: usize,
}

/// How much came so far.
#[derive(Debug, Clone, Copy, Default)]
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
            live: HashMap::default(),
            facets: OpenFacets::default(),
            edges: LiveEdges::default(),
            seen: Seen::default(),
            local: Vec::new(),
            live_max: 0,
        }
    }

    /// Checks a patch and gives the vertices that it finalizes to `finalize`.
    pub(super) fn patch(
        &mut self,
        patch: &Patch,
        ledger: &mut Ledger,
        mut finalize: impl FnMut(&Vertex, &mut Ledger) -> Result<(), Violation>,
    ) -> Result<(), Violation> {
        self.enter(patch, ledger)?;
        for tetrahedron in patch.tetrahedra() {
            self.tetrahedron(tetrahedron.map(|local| local as usize), ledger)?;
        }
        let mut finalized = patch.finalized.iter().map(|&local| local as usize).peekable();
        for (local, vertex) in self.local.iter().enumerate() {
            if finalized.next_if_eq(&local).is_some() {
                finalize(vertex, ledger)?;
            } else {
                self.live.insert(vertex.id, *vertex);
            }
        }
        self.edges.sweep(|id| self.live.contains_key(&id));
        self.seen.edges = self.edges.seen();
        Ok(())
    }

    /// Puts the vertices of a patch in the order of their local indices.
    fn enter(&mut self, patch: &Patch, ledger: &mut Ledger) -> Result<(), Violation> {
        self.local.clear();
        for (&at, id) in patch.new.iter().zip(patch.first_id..) {
            self.local.push(Vertex { id, at, tetrahedra: 0, edges: 0, open: 0 });
        }
        for id in &patch.imported {
            let Some(vertex) = self.live.remove(id) else {
                let message = format!("vertex {id} is used after it was finalized");
                return Err(Violation::new(Check::Finalization, message));
            };
            self.local.push(vertex);
        }
        ledger.add(Check::Finalization, patch.vertices() as u64);
        self.seen.vertices += patch.new.len() as u64;
        self.live_max = self.live_max.max(self.live.len() + self.local.len());
        Ok(())
    }

    fn tetrahedron(&mut self, locals: [usize; 4], ledger: &mut Ledger) -> Result<(), Violation> {
        let corners = locals.map(|local| self.local[local].corner());
        let [a, b, c, d] = corners;
        let turn = orientation(a.at, b.at, c.at, d.at);
        ledger.count(Check::Orientation, turn.exactly);
        if turn.sign != Ordering::Greater {
            let fault = if turn.sign == Ordering::Less { "is inverted" } else { "is flat" };
            let message = format!("tetrahedron {} {fault}", named(&corners));
            return Err(name_corners(Violation::new(Check::Orientation, message), &corners));
        }
        self.seen.tetrahedra += 1;
        let mut is_shared = [false; 4];
        for (side, is_shared) in is_shared.iter_mut().enumerate() {
            *is_shared = self.side(&corners, &locals, side, ledger)?;
        }
        for [i, j] in EDGES {
            // The edges of a facet that was open came with the tetrahedron beyond it.
            let is_old = (0..4).any(|side| is_shared[side] && side != i && side != j);
            let is_new = !is_old && self.edges.add(corners[i].id, corners[j].id);
            self.local[locals[i]].edges += u64::from(is_new);
            self.local[locals[j]].edges += u64::from(is_new);
        }
        locals.iter().for_each(|&local| self.local[local].tetrahedra += 1);
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
                self.seen.facets += 1;
                facet.iter().for_each(|&i| self.local[locals[i]].open += 1);
                Ok(false)
            }
            Meeting::Twin(opposite) => {
                facet.iter().for_each(|&i| self.local[locals[i]].open -= 1);
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

    /// Most vertices that were live at once.
    pub(super) fn live_max(&self) -> usize {
        self.live_max
    }

    /// The live vertex with the smallest id.
    pub(super) fn first_live(&self) -> Option<&Vertex> {
        self.live.values().min_by_key(|vertex| vertex.id)
    }
}

/// The ids, as they are written in messages.
pub(super) fn named(corners: &[Corner]) -> String {
    let ids: Vec<String> = corners.iter().map(|corner| corner.id.to_string()).collect();
    format!("({})", ids.join(", "))
}

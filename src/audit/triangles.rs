//! The part of the audit that whole and partial triangle meshes share: what can be proved triangle by
//! triangle, with the vertices that are live.

use std::cmp::Ordering;
use std::collections::HashMap;

use foldhash::fast::RandomState;

use super::check::{Check, Ledger, Violation};
use super::edges::{Corner, Meeting, OpenEdges};
use super::exact::plane::{Xy, in_circle, in_raised_circle, orientation};
use crate::bounds::Point;
use crate::stream::Patch;

/// What is asked of the edges of a triangulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standard {
    /// Interior edges are locally Delaunay.
    Delaunay,
    /// They are, and ties are resolved canonically, so that the triangulation is the only one.
    Canonical,
}

/// A vertex between its patch and its finalization.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vertex {
    pub(super) id: u64,
    pub(super) at: Point,
    /// Number of open edges that start here, and of those that end here.
    pub(super) leaving: u32,
    pub(super) entering: u32,
    /// Whether a triangle has it.
    pub(super) used: bool,
}

impl Vertex {
    pub(super) fn xy(&self) -> Xy {
        [self.at[0], self.at[1]]
    }

    fn corner(&self) -> Corner {
        Corner { id: self.id, at: self.xy() }
    }
}

/// Live vertices and open edges of the triangles seen so far.
pub(super) struct Triangles {
    standard: Standard,
    live: HashMap<u64, Vertex, RandomState>,
    pub(super) edges: OpenEdges,
    pub(super) triangles: u64,
    pub(super) vertices: u64,
    local: Vec<Vertex>,
    live_max: usize,
}

impl Triangles {
    pub(super) fn new(standard: Standard) -> Self {
        Triangles {
            standard,
            live: HashMap::default(),
            edges: OpenEdges::default(),
            triangles: 0,
            vertices: 0,
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
        for triangle in patch.triangles() {
            self.triangle(triangle.map(|local| local as usize), ledger)?;
        }
        let mut finalized = patch.finalized.iter().map(|&local| local as usize).peekable();
        for (local, vertex) in self.local.iter().enumerate() {
            if finalized.next_if_eq(&local).is_some() {
                finalize(vertex, ledger)?;
            } else {
                self.live.insert(vertex.id, *vertex);
            }
        }
        Ok(())
    }

    /// Puts the vertices of a patch in the order of their local indices.
    fn enter(&mut self, patch: &Patch, ledger: &mut Ledger) -> Result<(), Violation> {
        self.local.clear();
        for (&at, id) in patch.new.iter().zip(patch.first_id..) {
            self.local.push(Vertex { id, at, leaving: 0, entering: 0, used: false });
        }
        for id in &patch.imported {
            let Some(vertex) = self.live.remove(id) else {
                let message = format!("vertex {id} is used after it was finalized");
                return Err(Violation::new(Check::Finalization, message));
            };
            self.local.push(vertex);
        }
        ledger.add(Check::Finalization, patch.vertices() as u64);
        self.vertices += patch.new.len() as u64;
        self.live_max = self.live_max.max(self.live.len() + self.local.len());
        Ok(())
    }

    fn triangle(&mut self, locals: [usize; 3], ledger: &mut Ledger) -> Result<(), Violation> {
        let corners = locals.map(|local| self.local[local].corner());
        let [a, b, c] = corners;
        let turn = orientation(a.at, b.at, c.at);
        ledger.count(Check::Orientation, turn.exactly);
        if turn.sign != Ordering::Greater {
            let fault = if turn.sign == Ordering::Less { "is clockwise" } else { "is flat" };
            let message = format!("triangle ({}, {}, {}) {fault}", a.id, b.id, c.id);
            return Err(name_corners(Violation::new(Check::Orientation, message), &corners));
        }
        self.triangles += 1;
        for side in 0..3 {
            self.side([0, 1, 2].map(|i| locals[(side + i) % 3]), ledger)?;
        }
        Ok(())
    }

    /// Meets the edge from the first to the second corner with its twin.
    fn side(&mut self, locals: [usize; 3], ledger: &mut Ledger) -> Result<(), Violation> {
        let [a, b, c] = locals.map(|local| self.local[local].corner());
        let (from, to) = (locals[0], locals[1]);
        self.local[from].used = true;
        ledger.add(Check::Edges, 1);
        match self.edges.meet(a.id, b.id, c) {
            Meeting::Open => {
                self.local[from].leaving += 1;
                self.local[to].entering += 1;
                Ok(())
            }
            Meeting::Twin(opposite) => {
                self.local[from].entering -= 1;
                self.local[to].leaving -= 1;
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
        ledger.count(Check::Delaunay, place.exactly);
        let (check, fault) = match place.sign {
            Ordering::Less => return Ok(()),
            Ordering::Greater => (Check::Delaunay, "is not locally Delaunay"),
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

    /// The vertex, if it is live.
    pub(super) fn live(&self, id: u64) -> Option<&Vertex> {
        self.live.get(&id)
    }

    /// Most vertices that were live at once.
    pub(super) fn live_max(&self) -> usize {
        self.live_max
    }

    /// The live vertex with the smallest id that `is_wrong`.
    pub(super) fn first_live(&self, is_wrong: impl Fn(&Vertex) -> bool) -> Option<&Vertex> {
        self.live.values().filter(|vertex| is_wrong(vertex)).min_by_key(|vertex| vertex.id)
    }
}

fn name_corners(violation: Violation, corners: &[Corner]) -> Violation {
    corners.iter().fold(violation, |violation, corner| violation.with(corner.id, corner.point()))
}

//! Audit of a whole triangle mesh.

use super::check::{Check, Ledger, Violation};
use super::edges::Corner;
use super::extent::Extent;
use super::hull::{Hull, check_line};
use super::triangles::{Standard, Triangles, Vertex};
use crate::stream::{Header, Patch, Totals};

/// State of the audit of a triangle mesh.
pub(super) struct MeshAudit {
    triangles: Triangles,
    hull: Hull,
    /// Vertices that were finalized without a triangle: legal while there are no triangles at all.
    unused: Vec<Corner>,
    extent: Extent,
}

/// Checks that a triangle mesh must pass, in any case.
pub(super) const MESH_CHECKS: [Check; 9] = [
    Check::Orientation,
    Check::Edges,
    Check::Delaunay,
    Check::Vertices,
    Check::Finalization,
    Check::Hull,
    Check::Euler,
    Check::Counts,
    Check::Bounds,
];

impl MeshAudit {
    pub(super) fn new(header: &Header, standard: Standard) -> Self {
        MeshAudit {
            triangles: Triangles::new(standard),
            hull: Hull::default(),
            unused: Vec::new(),
            extent: Extent::new(header),
        }
    }

    pub(super) fn patch(&mut self, patch: &Patch, ledger: &mut Ledger) -> Result<(), Violation> {
        patch.new.iter().for_each(|&at| self.extent.add(at));
        let (hull, unused) = (&mut self.hull, &mut self.unused);
        self.triangles.patch(patch, ledger, |vertex, ledger| finalize(vertex, hull, unused, ledger))?;
        self.check_unused()
    }

    pub(super) fn end(&mut self, totals: &Totals, ledger: &mut Ledger) -> Result<(), Violation> {
        if let Some(vertex) = self.triangles.first_live(|_| true) {
            let message = format!("vertex {} is never finalized", vertex.id);
            return Err(Violation::new(Check::Finalization, message).with(vertex.id, vertex.at));
        }
        if self.triangles.triangles == 0 {
            check_line(&mut self.unused, ledger)?;
        } else {
            self.hull.check(&self.triangles.edges, ledger)?;
            self.check_euler(ledger)?;
        }
        self.check_counts(totals, ledger)?;
        self.extent.check_holds(ledger)
    }

    pub(super) fn triangles(&self) -> &Triangles {
        &self.triangles
    }

    fn check_unused(&self) -> Result<(), Violation> {
        match self.unused.first() {
            Some(corner) if self.triangles.triangles > 0 => {
                let message = format!("no triangle uses vertex {}", corner.id);
                Err(Violation::new(Check::Vertices, message).with(corner.id, corner.point()))
            }
            _ => Ok(()),
        }
    }

    fn check_euler(&self, ledger: &mut Ledger) -> Result<(), Violation> {
        let (vertices, triangles, hull) =
            (self.triangles.vertices, self.triangles.triangles, self.triangles.edges.len() as u64);
        ledger.add(Check::Euler, 1);
        if triangles + 2 + hull != 2 * vertices {
            let message = format!("{vertices} vertices and {hull} hull edges, but {triangles} triangles");
            return Err(Violation::new(Check::Euler, message));
        }
        Ok(())
    }

    fn check_counts(&self, totals: &Totals, ledger: &mut Ledger) -> Result<(), Violation> {
        ledger.add(Check::Counts, 1);
        if self.triangles.vertices.checked_add(totals.merged) != Some(totals.points) {
            let message = format!(
                "{} vertices and {} merged points are not the {} points of the input",
                self.triangles.vertices, totals.merged, totals.points
            );
            return Err(Violation::new(Check::Counts, message));
        }
        Ok(())
    }
}

/// An inner vertex has no open edge, a vertex of the hull one in and one out.
fn finalize(
    vertex: &Vertex,
    hull: &mut Hull,
    unused: &mut Vec<Corner>,
    ledger: &mut Ledger,
) -> Result<(), Violation> {
    ledger.add(Check::Vertices, 1);
    match (vertex.entering, vertex.leaving) {
        (0, 0) if !vertex.used => unused.push(Corner { id: vertex.id, at: vertex.xy() }),
        (0, 0) => {}
        (1, 1) => hull.add(vertex.id, vertex.xy()),
        (entering, leaving) => {
            let message = format!(
                "vertex {} is finalized with {entering} open edges in and {leaving} out, expected at most one",
                vertex.id
            );
            return Err(Violation::new(Check::Vertices, message).with(vertex.id, vertex.at));
        }
    }
    Ok(())
}

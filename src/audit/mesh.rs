//! Audit of a whole triangle mesh.

use super::check::{Check, Ledger, Violation};
use super::extent::Extent;
use super::hull::Hull;
use super::totals::check_points;
use super::triangles::{Corner, Fans, Standard, Triangles};
use super::unused::Unused;
use super::vertices::Vertex;
use spmesh_stream::{Header, Patch, Totals};

/// State of the audit of a triangle mesh.
pub(super) struct MeshAudit {
    triangles: Triangles,
    hull: Hull,
    unused: Unused<2>,
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
            unused: Unused::default(),
            extent: Extent::new(header),
        }
    }

    pub(super) fn patch(&mut self, patch: &Patch, ledger: &mut Ledger) -> Result<(), Violation> {
        patch.new.iter().for_each(|&at| self.extent.add(at));
        let (hull, unused) = (&mut self.hull, &mut self.unused);
        self.triangles.patch(patch, ledger, |vertex, ledger| finalize(vertex, hull, unused, ledger))?;
        if self.triangles.triangles > 0 { self.unused.check_none("triangle") } else { Ok(()) }
    }

    pub(super) fn end(&mut self, totals: &Totals, ledger: &mut Ledger) -> Result<(), Violation> {
        self.triangles.vertices.check_finalized()?;
        if self.triangles.triangles == 0 {
            self.unused.check_line(ledger)?;
        } else {
            self.hull.check(&self.triangles.edges, ledger)?;
            self.check_euler(ledger)?;
        }
        check_points(self.triangles.vertices.seen(), totals, ledger)?;
        self.extent.check_holds(ledger)
    }

    pub(super) fn triangles(&self) -> &Triangles {
        &self.triangles
    }

    fn check_euler(&self, ledger: &mut Ledger) -> Result<(), Violation> {
        let (vertices, triangles, hull) =
            (self.triangles.vertices.seen(), self.triangles.triangles, self.triangles.edges.len() as u64);
        ledger.add(Check::Euler, 1);
        if triangles + 2 + hull != 2 * vertices {
            let message = format!("{vertices} vertices and {hull} hull edges, but {triangles} triangles");
            return Err(Violation::new(Check::Euler, message));
        }
        Ok(())
    }
}

/// Checks a finalized vertex: an inner vertex has no open edge and its triangles go around it once; a vertex
/// of the hull has one open edge in and one out.
fn finalize(
    vertex: &Vertex<Fans>,
    hull: &mut Hull,
    unused: &mut Unused<2>,
    ledger: &mut Ledger,
) -> Result<(), Violation> {
    ledger.add(Check::Vertices, 1);
    let fans = vertex.star;
    match (fans.entering, fans.leaving) {
        (0, 0) if !fans.is_used => {
            unused.add(Corner::of(vertex));
            Ok(())
        }
        (0, 0) => fans.winding.check_once(vertex),
        (1, 1) => {
            hull.add(Corner::of(vertex));
            fans.winding.check_at_most_once(vertex)
        }
        (entering, leaving) => {
            let message = format!(
                "vertex {} is finalized with {entering} open edges in and {leaving} out, expected at most one",
                vertex.id
            );
            Err(Violation::new(Check::Vertices, message).with(vertex.id, vertex.at))
        }
    }
}

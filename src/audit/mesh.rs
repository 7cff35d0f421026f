//! Audit of a whole triangle mesh.

use super::border;
use super::check::{Check, Ledger, Violation};
use super::corner::Extent;
use super::hull::{Hull, Outline};
use super::points::check_points;
use super::triangles::{Corner, Fans, Standard, Triangles};
use super::unused::Unused;
use super::vertices::Vertex;
use spmesh_stream::{Constrained, Event, Header, Patch, Totals};

/// State of the audit of a triangle mesh.
pub(super) struct MeshAudit {
    constrained: Option<Constrained>,
    triangles: Triangles,
    hull: Hull,
    unused: Unused<2>,
    extent: Extent,
}

/// Checks that a triangle mesh with this header must pass, in any case.
pub(super) fn mesh_checks(header: &Header) -> Vec<Check> {
    let mut checks = vec![
        Check::Orientation,
        Check::Edges,
        Check::Vertices,
        Check::Finalization,
        Check::Counts,
        Check::Bounds,
    ];
    checks.extend(match header.constrained {
        None => &[Check::Delaunay][..],
        Some(_) => &[Check::ConstrainedDelaunay, Check::Constraints],
    });
    let is_cut = header.constrained.is_some_and(|constrained| constrained.is_cut);
    checks.extend(if is_cut { &[Check::Border][..] } else { &[Check::Hull, Check::Euler] });
    checks
}

impl MeshAudit {
    pub(super) fn new(header: &Header, standard: Standard) -> Self {
        let mut triangles = Triangles::new(standard);
        triangles.constraints = header.constrained.map(|_| Box::default());
        MeshAudit {
            constrained: header.constrained,
            triangles,
            hull: Hull::default(),
            unused: Unused::default(),
            extent: Extent::new(header),
        }
    }

    pub(super) fn patch(&mut self, patch: &Patch, ledger: &mut Ledger) -> Result<(), Violation> {
        patch.new.iter().for_each(|&at| self.extent.add(at));
        let is_cut = self.is_cut();
        let (hull, unused) = (&mut self.hull, &mut self.unused);
        self.triangles
            .patch(patch, ledger, |vertex, ledger| finalize(vertex, is_cut, hull, unused, ledger))?;
        // Vertices outside of a border that was cut keep no triangle.
        if self.triangles.triangles > 0 && !is_cut { self.unused.check_none("triangle") } else { Ok(()) }
    }

    pub(super) fn end(&mut self, totals: &Totals, ledger: &mut Ledger) -> Result<(), Violation> {
        self.triangles.vertices.check_finalized()?;
        if self.triangles.triangles == 0 && !self.is_cut() {
            self.unused.check_line(ledger)?;
            self.check_chains(None, ledger)?;
        } else if self.is_cut() {
            self.check_border(ledger)?;
            self.check_chains(None, ledger)?;
        } else {
            self.hull.check(&self.triangles.edges, ledger)?;
            self.check_euler(ledger)?;
            let outline = self.constrained.map(|_| self.hull.outline(&self.triangles.edges));
            self.check_chains(outline.as_ref(), ledger)?;
        }
        check_points(self.triangles.vertices.seen(), totals, ledger)?;
        self.extent.check_holds(ledger)
    }

    /// Takes what else constrains the mesh.
    pub(super) fn constraints(&mut self, event: &Event) {
        let Some(constraints) = &mut self.triangles.constraints else { return };
        match event {
            Event::Segments(segments) => constraints.add(segments),
            Event::OpenSegments(open) => constraints.add_open(open),
            _ => {}
        }
    }

    fn is_cut(&self) -> bool {
        self.constrained.is_some_and(|constrained| constrained.is_cut)
    }

    fn check_chains(&self, outline: Option<&Outline>, ledger: &mut Ledger) -> Result<(), Violation> {
        match &self.triangles.constraints {
            Some(constraints) => constraints.check_chains(outline, ledger),
            None => Ok(()),
        }
    }

    fn check_border(&self, ledger: &mut Ledger) -> Result<(), Violation> {
        let (Some(Constrained { kill, .. }), Some(constraints)) =
            (self.constrained, &self.triangles.constraints)
        else {
            return Ok(());
        };
        let triangle = |([from, to], apex): ([u64; 2], Corner)| {
            let [from, to] = [from, to].map(|id| self.hull.corner(id));
            [from, to, apex]
        };
        let triangles: Vec<[Corner; 3]> = self.triangles.edges.iter().map(triangle).collect();
        border::check(&triangles, constraints, kill, ledger)
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
/// of the hull has one open edge in and one out. A vertex of a border that was cut may have several.
fn finalize(
    vertex: &Vertex<Fans>,
    is_cut: bool,
    hull: &mut Hull,
    unused: &mut Unused<2>,
    ledger: &mut Ledger,
) -> Result<(), Violation> {
    ledger.add(Check::Vertices, 1);
    let fans = vertex.star;
    match (fans.entering, fans.leaving) {
        (0, 0) if !fans.is_used => {
            if !is_cut {
                unused.add(Corner::of(vertex));
            }
            Ok(())
        }
        (0, 0) => fans.winding.check_once(vertex),
        (entering, leaving) if entering == leaving && (entering == 1 || is_cut) => {
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

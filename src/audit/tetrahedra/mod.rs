//! Audit of a whole tetrahedral mesh.
//!
//! # Why the checks are enough
//! The argument is that of triangle meshes, one dimension up. Let every tetrahedron be strictly positive; let
//! every oriented facet meet its twin except those of one convex surface, once around ([`hull`] proves that);
//! let every vertex have a tetrahedron.
//!
//! *The tetrahedra tile the hull.* The boundaries of the tetrahedra, added up as chains, cancel along every
//! pair of twins, and what is left is the surface. So for every point off all facets, the number of
//! tetrahedra that cover it is how often the surface winds around it: once inside of the hull, never outside.
//! No two tetrahedra overlap and none is missing.
//!
//! *No two vertices coincide, and none lies in an edge, a facet or a tetrahedron of others.* Seen from a
//! vertex, its tetrahedra are positive triangles on a small sphere, joined side to side. If the vertex has no
//! open facets, the triangles have no border, so they cover every direction equally often, which is at least
//! once: all of its neighbourhood. If it has open facets, it is a corner of the surface, which passes each of
//! its positions once, and the border of the triangles is the outline of the convex cone inside of the
//! surface there. So the triangles cover the directions inside of the cone once more often than the others,
//! which is at least once. Another tetrahedron around the place, or a tetrahedron of a second vertex there,
//! would cover directions inside of the hull a second time. In particular a vertex on the hull has open
//! facets, so it is a corner of the surface, also inside of a flat part of it.
//!
//! *Oriented facets are unique*, because two tetrahedra on one side of a facet would overlap. A facet that is
//! used again while it is open is reported at once; a facet that is used again later is found by its
//! consequences.
//!
//! So the mesh is a tetrahedralization of its vertices. Lift them to the paraboloid: the piecewise linear
//! function over the hull that interpolates the lifts is convex across every interior facet, because the
//! facet is locally Delaunay. A segment between two points of the hull lies in the hull, and a function that
//! is convex at each facet crossed is convex along the segment; segments that meet an edge are limits of
//! others. So the function is convex, its graph is the lower hull of the lifted vertices, and the whole is
//! Delaunay. With perturbed lifts the same argument shows that the tetrahedralization is the canonical one.
//! That is unique: no five perturbed lifts lie in a hyperplane if four of the points are not in a plane.
//!
//! *Flat parts of the hull.* There the boundary facets are the Delaunay triangulation in their plane,
//! canonical if the mesh is. This needs no check: the sphere of the tetrahedron at a boundary facet is empty,
//! and so is the circle that it cuts from the plane; restricted to the plane, the convex function above is
//! the one whose graph is the lower hull of the lifts of the points there.
//!
//! The links of vertices, how often they are wound, and Euler's relation follow too. They are checked as a
//! test of the audit itself, and because a fault found at its vertex is easier to understand than one found
//! in the hull at the end.
//!
//! *Weights.* With lifts that are less by the weights, all of this holds for the regular tetrahedralization.
//! A vertex that no tetrahedron has must then lie in one that follows, and not below the graph ([`hidden`]).
//!
//! *Facets and edges that are closed are forgotten.* If one comes again, its tetrahedra lie where others are,
//! so that something is covered twice, as above. So the audit need not remember it.

mod census;
mod faces;
mod hidden;
mod hull;
mod live;
mod partial;

use super::check::{Check, Ledger, Violation};
use super::corner::Extent;
use super::points::check_points;
use super::unused::Unused;
use super::vertices::Vertex;
use super::{Standard, corner};
pub use census::{Census, Counts, Faults};
use hidden::Hidden;
use hull::Hull;
pub(super) use live::LiveTetrahedra;
use live::{Seen, Star};
use spmesh_stream::{Header, Patch, Totals};

/// A vertex of a tetrahedron.
type Corner = corner::Corner<3>;

/// State of the audit of a tetrahedral mesh.
///
/// Memory: live vertices, open facets and their edges, and the hull.
pub(super) struct TetrahedraAudit {
    tetrahedra: LiveTetrahedra,
    hull: Hull,
    unused: Unused<3>,
    labels: u64,
    extent: Extent,
}

/// Checks that a tetrahedral mesh must pass, in any case.
pub(super) const TETRAHEDRA_CHECKS: [Check; 9] = [
    Check::Orientation,
    Check::Facets,
    Check::Delaunay,
    Check::Vertices,
    Check::Finalization,
    Check::Hull,
    Check::Euler,
    Check::Counts,
    Check::Bounds,
];

impl TetrahedraAudit {
    pub(super) fn new(header: &Header, standard: Standard) -> Self {
        let mut tetrahedra = LiveTetrahedra::new(standard);
        tetrahedra.weighted = header.weights().map(|weights| (weights, Hidden::default()));
        TetrahedraAudit {
            tetrahedra,
            hull: Hull::default(),
            unused: Unused::default(),
            labels: 0,
            extent: Extent::new(header),
        }
    }

    pub(super) fn patch(&mut self, patch: &Patch, rows: &[u8], ledger: &mut Ledger) -> Result<(), Violation> {
        patch.new.iter().for_each(|&at| self.extent.add(at));
        let (hull, unused) = (&mut self.hull, &mut self.unused);
        self.tetrahedra
            .patch(patch, rows, ledger, |vertex, ledger| finalize(vertex, hull, unused, ledger))?;
        if let Some((_, hidden)) = &mut self.tetrahedra.weighted {
            self.unused.drain().for_each(|corner| hidden.add(corner));
        }
        if self.tetrahedra.seen().tetrahedra > 0 { self.unused.check_none("tetrahedron") } else { Ok(()) }
    }

    /// Checks that labels follow their vertices.
    pub(super) fn labels(&mut self, labels: &[u64], ledger: &mut Ledger) -> Result<(), Violation> {
        ledger.add(Check::Labels, labels.len() as u64);
        self.labels += labels.len() as u64;
        let vertices = self.tetrahedra.seen().vertices;
        if self.labels > vertices {
            let message = format!("{} labels, but only {vertices} vertices so far", self.labels);
            return Err(Violation::new(Check::Labels, message));
        }
        Ok(())
    }

    pub(super) fn end(&mut self, totals: &Totals, ledger: &mut Ledger) -> Result<(), Violation> {
        self.tetrahedra.vertices.check_finalized()?;
        if self.tetrahedra.seen().tetrahedra == 0 {
            let hidden = self.tetrahedra.weighted.take().map(|(_, hidden)| hidden.into_corners());
            hidden.into_iter().flatten().for_each(|corner| self.unused.add(corner));
            self.unused.check_plane(ledger)?;
        } else {
            if let Some((_, hidden)) = &mut self.tetrahedra.weighted {
                hidden.check_held()?;
            }
            self.hull.check(self.tetrahedra.facets.iter(), ledger)?;
            self.check_euler(ledger)?;
        }
        check_points(self.tetrahedra.seen().vertices, totals, ledger)?;
        self.check_labels()?;
        self.extent.check_holds(ledger)
    }

    pub(super) fn open_facets(&self) -> usize {
        self.tetrahedra.facets.len()
    }

    /// Most vertices that were live at once.
    pub(super) fn live_max(&self) -> usize {
        self.tetrahedra.vertices.live_max()
    }

    /// Checks that the mesh is a ball and its surface a sphere.
    fn check_euler(&self, ledger: &mut Ledger) -> Result<(), Violation> {
        let seen = self.tetrahedra.seen();
        let (hull_facets, hull_vertices) = (self.tetrahedra.facets.len() as u64, self.hull.len());
        // Hidden vertices are in no simplex.
        let hidden = self.tetrahedra.weighted.as_ref().map_or(0, |(_, hidden)| hidden.seen());
        let seen = Seen { vertices: seen.vertices - hidden, ..seen };
        ledger.add(Check::Euler, 2);
        if seen.vertices + seen.facets != seen.edges + seen.tetrahedra + 1 {
            let message = format!(
                "{} vertices - {} edges + {} facets - {} tetrahedra is not 1",
                seen.vertices, seen.edges, seen.facets, seen.tetrahedra
            );
            return Err(Violation::new(Check::Euler, message));
        }
        if hull_facets + 4 != 2 * hull_vertices {
            let message = format!("the hull has {hull_facets} facets, but {hull_vertices} vertices");
            return Err(Violation::new(Check::Euler, message));
        }
        Ok(())
    }

    fn check_labels(&self) -> Result<(), Violation> {
        let vertices = self.tetrahedra.seen().vertices;
        if self.labels > 0 && self.labels != vertices {
            let message = format!("{} labels, but {vertices} vertices", self.labels);
            return Err(Violation::new(Check::Labels, message));
        }
        Ok(())
    }
}

fn finalize(
    vertex: &Vertex<Star>,
    hull: &mut Hull,
    unused: &mut Unused<3>,
    ledger: &mut Ledger,
) -> Result<(), Violation> {
    ledger.add(Check::Vertices, 1);
    if vertex.star.tetrahedra == 0 {
        unused.add(Corner::of(vertex));
        return Ok(());
    }
    if vertex.star.open > 0 {
        hull.add(Corner::of(vertex));
    }
    check_link(vertex)
}

/// Checks that the link of an inner vertex is a sphere and the link of a vertex of the hull a disk, by
/// Euler's relation, and that the link is wound once.
///
/// A link has a vertex per edge, a triangle per tetrahedron and a border edge per open facet. Of its edges,
/// inner ones are sides of two triangles, and border edges of one.
fn check_link(vertex: &Vertex<Star>) -> Result<(), Violation> {
    let Star { tetrahedra, edges, open, winding } = vertex.star;
    // Twice V - E + F, with 2 E = 3 F + border.
    let (twice, shape) = if open > 0 { (2, "half ball") } else { (4, "ball") };
    if 2 * edges != tetrahedra + open + twice {
        let message = format!(
            "the tetrahedra around vertex {} are no {shape}: {tetrahedra} of them, with {edges} edges \
             and {open} open facets",
            vertex.id
        );
        return Err(Violation::new(Check::Vertices, message).with(vertex.id, vertex.at));
    }
    if open > 0 { winding.check_at_most_once(vertex) } else { winding.check_once(vertex) }
}

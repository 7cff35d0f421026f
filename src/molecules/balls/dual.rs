//! The power diagram against the union of the balls: which of its vertices the balls cover, and where its
//! edges cross the surface.
//!
//! All decisions go by one power for each tetrahedron and one test for each facet. So what is made of them on
//! different balls fits together, however they are rounded.

use super::shares::Foot;
use super::tile::Tile;
use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::simplex::TETRAHEDRON_FACETS;
use spmesh_delaunay::vector::{cross, difference, dot};

/// A tile, with the power of each orthocentre.
pub(super) struct Dual<'t> {
    pub(super) tile: &'t Tile<'t>,
    powers: Vec<f64>,
}

impl<'t> Dual<'t> {
    pub(super) fn new(tile: &'t Tile<'t>) -> Self {
        Dual { tile, powers: (0..tile.tetrahedra().len()).map(|t| tile.power(t)).collect() }
    }

    /// Whether no ball covers the orthocentre of a tetrahedron.
    pub(super) fn is_empty(&self, t: usize) -> bool {
        self.powers[t] > 0.0
    }

    /// The tetrahedron across a facet, and its corner opposite to it.
    pub(super) fn across(&self, t: usize, corner: usize) -> Option<(usize, usize)> {
        let other = self.tile.tetrahedra()[t].neighbour(corner)?;
        Some((other.tetrahedron as usize, other.corner as usize))
    }

    /// Whether the facet opposite to a corner separates a tetrahedron from its orthocentre.
    pub(super) fn flows(&self, t: usize, corner: usize) -> bool {
        let vertices = self.tile.tetrahedra()[t].vertices;
        let [a, b, c] = TETRAHEDRON_FACETS[corner].map(|i| self.tile.point(vertices[i]));
        let normal = cross(difference(b, a), difference(c, a));
        let apex = dot(normal, difference(self.tile.point(vertices[corner]), a));
        let centre = dot(normal, difference(self.tile.centre(t), a));
        (if apex < 0.0 { -centre } else { centre }) < 0.0
    }

    /// Whether the balls cover the facet's place in the dual: some point of the line of equal power between
    /// the two orthocentres.
    pub(super) fn is_closed(&self, t: usize, corner: usize) -> bool {
        let Some((other, across)) = self.across(t, corner) else { return false };
        let least = self.powers[t].min(self.powers[other]);
        if least <= 0.0 || self.flows(t, corner) || self.flows(other, across) {
            return least <= 0.0;
        }
        // The orthocentre of the facet lies between.
        self.foot(t, corner).is_some_and(|(foot, _)| foot.power <= 0.0)
    }

    /// Whether the line of equal power crosses the surface twice between two orthocentres that are both
    /// outside.
    pub(super) fn dips(&self, t: usize, corner: usize) -> bool {
        let Some((other, across)) = self.across(t, corner) else { return false };
        self.is_empty(t)
            && self.is_empty(other)
            && !self.flows(t, corner)
            && !self.flows(other, across)
            && self.foot(t, corner).is_some_and(|(foot, _)| foot.power < 0.0)
    }

    /// Where the line of equal power of a facet crosses the surface on its way to the orthocentre of `t`,
    /// which is outside.
    pub(super) fn crossing(&self, t: usize, corner: usize) -> Point3 {
        let apex = self.tile.point(self.tile.tetrahedra()[t].vertices[corner]);
        match self.foot(t, corner) {
            Some((foot, first)) => foot.meeting(first, apex),
            None => self.tile.centre(t),
        }
    }

    /// The foot of a facet and the point that it is relative to: the same from both sides.
    fn foot(&self, t: usize, corner: usize) -> Option<(Foot, Point3)> {
        let vertices = self.tile.tetrahedra()[t].vertices;
        let mut facet = TETRAHEDRON_FACETS[corner].map(|i| vertices[i]);
        facet.sort_unstable();
        let points = facet.map(|v| self.tile.point(v));
        Some((Foot::of(points, facet.map(|v| self.tile.radius(v)))?, points[0]))
    }
}

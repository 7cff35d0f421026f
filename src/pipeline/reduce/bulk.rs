//! The dimension-dependent part of the reduction: a bulk kernel and its triangulation.

use super::residual::Residual;
use spmesh_base::error::Result;
use spmesh_delaunay::delaunay3::Corners;
use spmesh_delaunay::predicates::PredicateCounts;
use spmesh_stream::model::bounds::Region;
use spmesh_stream::{Coordinates, Kind, Weights};
use std::num::NonZeroUsize;

/// A facet of a simplex, named by the corner opposite to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Facet {
    pub(super) simplex: u32,
    pub(super) corner: u32,
}

/// Where a wall was found.
#[derive(Debug, Clone, Copy)]
pub(super) enum WallSide {
    /// As a facet of the simplex on its final side.
    Final(Facet),
    /// As a facet of the hull, of the simplex that is not final: the points on the final side are gone.
    Open(Facet),
}

/// A bulk kernel of D dimensions with its last triangulation: simplices of D + 1 corners. A corner is the
/// index of a point in the residual that was triangulated.
pub(super) trait Bulk<const D: usize>: Default {
    /// The corners of a simplex.
    type Corners: AsRef<[u32]> + Copy;

    /// A test of whether balls lie in a region.
    type Balls;

    /// Kinds of a whole mesh, of the mesh of a region with its residual, and of a residual alone.
    const MESH: Kind;
    const PARTIAL_MESH: Kind;
    const RESIDUAL: Kind;

    /// Names of a simplex, of its facets, and of a triangulation in messages.
    const SIMPLEX: &'static str;
    const FACET: &'static str;
    const TRIANGULATION: &'static str;

    /// Bytes of a point that waits in a residual, with its walls; and of one that is being triangulated,
    /// beyond those.
    const WAITING_BYTES: usize;
    const KERNEL_BYTES: usize;

    /// Points of a node above others, and bytes of the blocks of any node, above which their memory goes back
    /// to the system: other nodes need far less.
    const KEPT_POINTS_MAX: usize;
    const KEPT_BLOCKS_MAX: usize;

    /// Nodes of fewer raw points are not sampled before they are triangulated.
    const SAMPLED_MIN: usize;

    /// Whether nodes of fewer raw points are passed up untriangulated: too many of their points are near the
    /// sides.
    const PASSES_FEW: bool;

    /// Nodes of fewer points on a surface are passed up untriangulated, if there is memory for that.
    const SURFACE_MAX: usize = 0;

    /// Gives the next node so many threads. Then neither the order of its simplices nor that of their corners
    /// depends on them.
    fn share(&mut self, threads: NonZeroUsize) {
        let _ = threads;
    }

    /// Allows triangulations so many bytes beyond [`Bulk::KERNEL_BYTES`] for each point.
    fn allow(&mut self, bytes: u64) {
        let _ = bytes;
    }

    /// Gives back memory, if the last triangulation of so many points took more than that.
    fn shrink(&mut self, points: usize) {
        let _ = points;
    }

    /// Triangulates `points` canonically; if they have weights, as their regular triangulation.
    fn triangulate(&mut self, points: &Residual<D>, weights: Option<Weights>) -> Result<()>;

    /// Finds the order of [`Bulk::nth`].
    fn arrange(&mut self) {}

    /// The corners of those simplices that `keep` accepts, in the order of [`Bulk::nth`] and as by
    /// [`Bulk::written`], but as places in the vertices that come with them; if the threads of the node can
    /// find them faster than one by one. The triangulation is empty then.
    fn take_written(&mut self, keep: impl Fn(usize) -> bool) -> Result<Option<Corners>> {
        let _ = keep;
        Ok(None)
    }

    /// Points that are not vertices, each with the vertex that it coincides with. The vertex has the least
    /// index.
    fn duplicates(&mut self) -> &mut Vec<[u32; 2]>;

    /// Points that no simplex has, because their cell in the power diagram is empty.
    fn hidden(&self) -> &[u32] {
        &[]
    }

    /// Number of simplices.
    fn len(&self) -> usize;

    /// The `k`-th simplex in an order that keeps neighbours close to each other, after [`Bulk::arrange`].
    fn nth(&self, k: usize) -> u32;

    /// The corners of a simplex, in positive orientation.
    fn corners(&self, simplex: u32) -> Self::Corners;

    /// The corners of a simplex in the order in which they are written, in positive orientation.
    fn written(&self, simplex: u32) -> Self::Corners {
        self.corners(simplex)
    }

    /// The same facet, as a facet of the neighbouring simplex; `None` on the hull.
    fn neighbour(&self, facet: Facet) -> Option<Facet>;

    /// The vertices on the hull: all vertices, if there are no simplices.
    fn hull_vertices(&self) -> impl Iterator<Item = u32>;

    /// The facets of the hull, each as a facet of its one simplex.
    fn hull_facets(&self) -> impl Iterator<Item = Facet>;

    /// Calls `found` with every wall.
    fn find(&mut self, walls: &[[u32; D]], found: impl FnMut(WallSide)) -> std::result::Result<(), usize>;

    /// A facet as a wall with its simplex on the final side.
    fn wall(&self, facet: Facet) -> [u32; D];

    /// The test of balls in `region`, for points of these coordinates and weights.
    fn balls(coordinates: &Coordinates, region: Region<D>, weights: Option<Weights>) -> Self::Balls;

    /// Whether the ball around `simplex` certainly lies inside. With weights, it is the ball that no point
    /// outside of it can be in conflict with.
    fn is_inside(&self, simplex: u32, points: &Residual<D>, balls: &Self::Balls) -> bool;

    /// Keeps those of the `kept` simplices, from the `first` on in the order of [`Bulk::nth`], whose ball
    /// certainly lies inside, as by [`Bulk::is_inside`].
    fn keep_inside(&self, first: usize, kept: &mut [bool], points: &Residual<D>, balls: &Self::Balls) {
        for (k, kept) in (first..).zip(kept).filter(|(_, kept)| **kept) {
            *kept = self.is_inside(self.nth(k), points, balls);
        }
    }

    /// Decisions of the predicates so far.
    fn counts(&self) -> &PredicateCounts;
}

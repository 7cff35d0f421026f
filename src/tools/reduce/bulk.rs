//! What the reduction has to know of its dimension: how points are triangulated in bulk, and what came of it.

use super::residual::Residual;
use spmesh_core::error::Result;
use spmesh_geometry::predicates::PredicateCounts;
use spmesh_model::bounds::Region;
use spmesh_stream::{Coordinates, Kind};

/// A facet of a simplex, named by the corner opposite to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Facet {
    pub(super) simplex: u32,
    pub(super) corner: u32,
}

/// A bulk kernel of D dimensions with what it made last: simplices of D + 1 corners, which are points by their index in
/// the residual that was triangulated.
pub(super) trait Bulk<const D: usize>: Default {
    /// D + 1 points.
    type Corners: AsRef<[u32]> + Copy;

    /// Decides which balls lie in a region.
    type Balls;

    /// What a whole mesh is called, and that of a region.
    const MESH: Kind;
    const PARTIAL_MESH: Kind;

    /// What a simplex is called.
    const SIMPLEX: &'static str;

    /// Whether triangulating a node may leave most of its points, so that they are better passed up as they are.
    const MAY_LEAVE_MOST: bool;

    /// Triangulates `points` canonically.
    ///
    /// # Errors
    /// As the kernel's.
    fn triangulate(&mut self, points: &Residual<D>) -> Result<()>;

    /// Points that are no vertices, each with the vertex that it coincides with: the one of least index.
    fn duplicates(&mut self) -> &mut Vec<[u32; 2]>;

    /// Number of simplices.
    fn len(&self) -> usize;

    /// The `k`-th simplex where neighbours should follow each other.
    fn nth(&self, k: usize) -> u32;

    /// The corners of a simplex, in positive orientation.
    fn corners(&self, simplex: u32) -> Self::Corners;

    /// The same facet as that of the other simplex; `None` beyond the hull.
    fn across(&self, facet: Facet) -> Option<Facet>;

    /// The vertices on the boundary of the hull: all of them, if there are no simplices.
    fn hull_vertices(&self) -> impl Iterator<Item = u32>;

    /// The facets beyond which there is no simplex.
    fn hull_facets(&self) -> impl Iterator<Item = Facet>;

    /// Tells `found` where the walls are: the facets, as those of the simplices on their final side.
    ///
    /// # Errors
    /// [`spmesh_core::error::ErrorKind::Malformed`] if a wall is no facet of this triangulation.
    fn find(&mut self, walls: &[[u32; D]], found: impl FnMut(Facet)) -> Result<()>;

    /// A facet as a wall behind which its simplex is final.
    fn wall(&self, facet: Facet) -> [u32; D];

    /// Decides for points of these coordinates which balls lie in `region`.
    fn balls(coordinates: &Coordinates, region: Region<D>) -> Self::Balls;

    /// Whether the ball around `simplex` certainly lies inside.
    fn is_inside(&self, simplex: u32, points: &Residual<D>, balls: &Self::Balls) -> bool;

    /// Decisions of the predicates so far.
    fn counts(&self) -> &PredicateCounts;
}

//! Figures of a run, for `--stats`.

use super::duplicates::Merged;
use spmesh_delaunay::predicates::PredicateCounts;

/// Figures of one run of the reduction.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Stats {
    /// Points triangulated.
    pub points: u64,
    /// Points merged with another one that they coincide with (in the plane: in x and y).
    pub merged: u64,
    /// Those of them that lost their elevation to that of a point that comes before, with
    /// [`Duplicates::First`](crate::reduce::Duplicates::First).
    pub by_order: u64,
    /// Points left out because they lie outside of the region.
    pub outside: u64,
    /// Vertices written.
    pub vertices: u64,
    /// Vertices written that other parts of the mesh have.
    pub shared: u64,
    /// Triangles or tetrahedra written.
    pub simplices: u64,
    /// Cell tags read.
    pub cells: u64,
    /// Leaves with points.
    pub leaves: u64,
    /// Nodes above the leaves with points.
    pub inner_nodes: u64,
    /// Points of the largest leaf.
    pub leaf_max: u64,
    /// Points of the largest node above the leaves.
    pub inner_node_max: u64,
    /// Points of the root, where everything is final.
    pub root_points: u64,
    /// High-water mark of points held because their cell was not final.
    pub held_max: u64,
    /// Levels of the input's finalization tree below its root.
    pub level: u64,
    /// Length of the input streams.
    pub input_bytes: u64,
    /// High-water mark of simplices that are not final, over the nodes that wait for their parent.
    pub active_max: u64,
    /// High-water mark of residual points that wait for their parent.
    pub residual_max: u64,
    /// Points that no tag covered, which were held until the end.
    pub untagged: u64,
    /// Points of the residual that a partial run wrote.
    pub residual: u64,
    /// High-water mark of vertices that are written but not finalized: the width of the mesh.
    pub width: u64,
    /// Decisions of the predicates, by stage.
    pub predicates: PredicateCounts,
}

impl Stats {
    /// Adds merged points.
    pub(super) fn count(&mut self, merged: Merged) {
        self.merged += merged.points;
        self.by_order += merged.by_order;
    }
}

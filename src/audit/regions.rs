//! Counts the regions of a stream of points in regions.

use spmesh_stream::PointRegion;

/// Counts of regions of points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RegionInventory {
    /// Regions.
    pub regions: u64,
    /// Points that the stream has besides the first time it has each.
    pub copies: u64,
    /// Points of the greatest region, copies included.
    pub points_max: u64,
}

impl RegionInventory {
    /// Adds a region.
    pub(super) fn region(&mut self, region: &PointRegion) {
        self.regions += 1;
        self.copies = self.copies.saturating_add(region.again).saturating_add(region.last);
        self.points_max = self.points_max.max(region.points());
    }
}

//! What the formats of an input have in common: what a file states, and a pass over its points.

use super::placement::Placement;
use spmesh_core::error::Result;
use spmesh_model::bounds::{Bounds, Point};
use spmesh_stream::{Coordinates, Crs};

/// About how many points a batch has: few enough to stay in the cache of a core on their way.
pub(super) const BATCH_POINTS: usize = 1 << 14;

/// One pass over the points of one file.
pub(super) trait Pass: Send {
    /// Puts the next points into `batch`, about `BATCH_POINTS` of them; none may be left after filters.
    /// Returns false at the end of the file, with nothing put.
    fn next_batch(&mut self, placement: &mut Placement, batch: &mut Vec<Point>) -> Result<bool>;
}

/// What a file says of itself.
#[derive(Debug)]
pub(super) struct Stated {
    pub(super) coordinates: Coordinates,
    /// Whether points have a third coordinate; `None` if the file has no points to tell.
    pub(super) has_z: Option<bool>,
    pub(super) crs: Crs,
    /// Bounding box, in stored coordinates.
    pub(super) bounds: Option<Bounds>,
    pub(super) points: Option<u64>,
}

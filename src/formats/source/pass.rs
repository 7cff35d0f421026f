//! The interface of all formats of an input: what a file states, and a pass over its points.

use std::sync::Arc;

use crate::source::cut::Cut;
use crate::source::placement::Placement;
use crate::source::row_plan::Offer;
use spmesh_base::error::Result;
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::{Coordinates, Crs};

/// Approximate number of points in a batch: few enough to stay in a core's cache between stages.
pub(crate) const BATCH_POINTS: usize = 1 << 14;

/// One pass over the points of one file.
pub(crate) trait Pass: Send {
    /// Appends the next points to `batch`, about `BATCH_POINTS` of them, possibly none after filters, and their
    /// rows to `rows`, if points carry attributes. Returns false at the end of the file, without appending any.
    fn next_batch(
        &mut self,
        placement: &mut Placement,
        batch: &mut Vec<Point>,
        rows: &mut Vec<u8>,
    ) -> Result<bool>;

    /// Records decoded so far, before any filter; 0 for formats without records.
    fn records(&self) -> u64 {
        0
    }

    /// At the end: what is left of the file, if the pass found that it was cut off.
    fn cut(&self) -> Option<Cut> {
        None
    }
}

/// What a file states about itself.
#[derive(Debug)]
pub(crate) struct Stated {
    pub(crate) coordinates: Coordinates,
    /// Whether points have a third coordinate; `None` if the file has no point to show it.
    pub(crate) has_z: Option<bool>,
    pub(crate) crs: Arc<Crs>,
    /// Bounding box, in stored coordinates.
    pub(crate) bounds: Option<Bounds>,
    pub(crate) points: Option<u64>,
    /// What points can carry beside their coordinates.
    pub(crate) offers: Arc<Vec<Offer>>,
}

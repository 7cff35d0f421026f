//! The interface of all formats of an input: what a file states, and a pass over its points.

use std::fmt;
use std::sync::Arc;

use crate::drivers::Format;
use crate::source::cut::Cut;
use crate::source::options::SourceOptions;
use crate::source::origin::Origin;
use crate::source::placement::Placement;
use crate::source::row_plan::{Offer, RowPlan};
use spmesh_base::error::Result;
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::{Coordinates, Crs};

/// Approximate number of points in a batch: few enough to stay in a core's cache between stages.
pub(crate) const BATCH_POINTS: usize = 1 << 14;

/// One pass over the points of one file.
pub(crate) trait Pass: Send {
    /// Appends the next points to `batch`, about `BATCH_POINTS` of them, possibly none after filters, and
    /// their rows to `rows`, if points carry attributes. Returns false at the end of the file, without
    /// appending any.
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

/// A file that is read, and how.
pub(crate) struct Opening<'f> {
    pub(crate) origin: &'f Origin,
    /// Its name in messages.
    pub(crate) name: &'f str,
    pub(crate) format: Format,
    pub(crate) options: &'f SourceOptions,
}

/// What the points of a file are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sort {
    Plain,
    /// Records of LAS of this format.
    Records(u8),
    Atoms,
}

/// Starts a pass over the points of a file, with these rows.
type StartPass = dyn Fn(&Opening, RowPlan) -> Result<Box<dyn Pass>> + Send + Sync;

/// A file whose header has been read.
pub(crate) struct Content {
    pub(crate) stated: Stated,
    pub(crate) sort: Sort,
    /// Whether a pass takes more than copying bytes.
    pub(crate) is_costly: bool,
    /// What is left of the file, if that is known to be cut off.
    pub(crate) cut: Option<Cut>,
    pub(crate) pass: Box<StartPass>,
}

impl Content {
    /// Points of which passes are cheap.
    pub(crate) fn new(
        stated: Stated,
        pass: impl Fn(&Opening, RowPlan) -> Result<Box<dyn Pass>> + Send + Sync + 'static,
    ) -> Content {
        Content { stated, sort: Sort::Plain, is_costly: false, cut: None, pass: Box::new(pass) }
    }
}

impl fmt::Debug for Content {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Content").field("stated", &self.stated).finish_non_exhaustive()
    }
}

//! The interface of an input of points.

use spmesh_base::error::Result;
use spmesh_stream::model::attributes::Attributes;
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::{Coordinates, Crs};

/// Properties of an input that are known before its points are read.
#[derive(Debug, Clone)]
pub struct Description {
    /// Encoding that all points of the input share.
    pub coordinates: Coordinates,
    /// Dimensions of the geometry: 2 or 3.
    pub dims: u8,
    /// Whether two-dimensional points carry an elevation.
    pub has_elevation: bool,
    /// Coordinate reference system that all files share.
    pub crs: Crs,
    /// Bounding box that the headers state, in stored coordinates; not verified.
    pub stated_bounds: Option<Bounds>,
    /// What points carry beside their coordinates.
    pub attributes: Attributes,
    /// Number of points that the headers state, before filters.
    pub stated_points: Option<u64>,
}

/// One pass over an input.
pub trait PointReader: Send {
    /// Replaces the content of `batch` with the next points, in stored coordinates of the description;
    /// an empty batch after the call means the end of the input.
    fn next_batch(&mut self, batch: &mut Vec<Point>) -> Result<()>;

    /// The rows of the points of the last batch; empty if points carry no attributes.
    fn rows(&self) -> &[u8] {
        &[]
    }

    /// Points dropped so far because a coordinate is not finite.
    fn invalid(&self) -> u64;

    /// Records of LAS files decoded so far, before any filter; 0 for inputs of other formats.
    fn records(&self) -> u64 {
        0
    }

    /// The file that the last batch is from: its number in the order of the input, from 0 on.
    fn file(&self) -> usize {
        0
    }
}

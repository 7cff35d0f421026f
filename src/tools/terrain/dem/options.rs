//! What a raster shows, and how it is drawn and written.

use super::facet::out_of_range;
use spmesh_core::error::Result;
use spmesh_geometry::predicates::Point2;
use spmesh_io::raster::{self, Grid, Light, RasterFile, RasterOptions, Reduction};
use spmesh_stream::Crs;

/// The quantity that cells hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Attribute {
    /// The elevation at the centre.
    Elevation,
    /// The angle of the triangle with the horizontal, in degrees.
    Slope,
    /// The direction of steepest descent, in degrees clockwise from north; no data where a triangle is level.
    Aspect,
    /// The brightness of the triangle in some light, from 0 to 255.
    Hillshade(Light),
}

/// What is drawn, and the memory for it.
#[derive(Debug, Clone)]
pub struct Options {
    /// The quantity that cells hold.
    pub attribute: Attribute,
    /// Triangles with a longer edge are left out. Units: those of the world.
    pub kill: Option<f64>,
    /// Cells without data are filled from data at most this many cells away.
    pub fill: Option<u32>,
    /// Bytes for tiles in memory; the others wait in a temporary file.
    pub memory: u64,
    /// How the raster is written.
    pub raster: RasterOptions,
}

impl Options {
    /// The raster file.
    pub(super) fn file<'a>(&'a self, grid: Grid, crs: &'a Crs) -> RasterFile<'a> {
        // Directions have no mean: that of north-east and north-west would be south.
        let reduction = match self.attribute {
            Attribute::Aspect => Reduction::First,
            _ => Reduction::Mean,
        };
        let are_elevations = self.attribute == Attribute::Elevation;
        // Holes are filled from tiles that are already written, so these must be readable.
        let is_staged = self.fill.is_some();
        RasterFile { options: &self.raster, grid, crs, are_elevations, reduction, is_staged }
    }
}

impl Attribute {
    /// The value of a whole plane, from its gradient in world coordinates; `None` if it varies.
    ///
    /// # Errors
    /// Usage, if the gradient overflows.
    pub(super) fn of_plane(self, gradient: Point2) -> Result<Option<f32>> {
        let value = match self {
            Attribute::Elevation => return Ok(None),
            _ if !gradient.iter().all(|part| part.is_finite()) => return Err(out_of_range()),
            Attribute::Slope => raster::slope(gradient),
            Attribute::Aspect => raster::aspect(gradient),
            Attribute::Hillshade(light) => light.shade(gradient),
        };
        Ok(Some(value as f32))
    }
}

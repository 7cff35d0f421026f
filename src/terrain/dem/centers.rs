//! The centres of cells in stored coordinates.

use super::axis::Axis;
use spmesh_delaunay::predicates::Point2;
use spmesh_formats::raster::Grid;
use spmesh_stream::Coordinates;

/// The centres of the cells of a grid, in stored coordinates. Each is an exact point after one rounding, so
/// triangles that cover the plane cover each centre.
#[derive(Debug)]
pub(super) struct Centers {
    pub(super) columns: Axis,
    pub(super) rows: Axis,
    /// Steps of x and y, in units of elevations.
    scale: Point2,
}

impl Centers {
    /// Centres for elevations of which one unit is `unit_of_z` units of x and y.
    pub(super) fn new(grid: Grid, coordinates: &Coordinates, unit_of_z: f64) -> Centers {
        let (scale, offset) = match coordinates {
            Coordinates::F64 => ([1.0; 2], [0.0; 2]),
            Coordinates::I32 { scale, offset } => ([scale[0], scale[1]], [offset[0], offset[1]]),
        };
        let Grid { left, top, step, columns, rows } = grid;
        Centers {
            columns: Axis::new(left, step, columns, scale[0], offset[0]),
            rows: Axis::new(top, -step, rows, scale[1], offset[1]),
            scale: scale.map(|step| step / unit_of_z),
        }
    }

    /// Converts a gradient from stored to world coordinates, all in one unit.
    pub(super) fn gradient_to_world(&self, gradient: Point2) -> Point2 {
        [0, 1].map(|axis| gradient[axis] / self.scale[axis])
    }
}

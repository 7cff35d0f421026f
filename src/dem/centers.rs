//! Where the centres of cells are, in the coordinates that vertices are stored in.

use std::ops::Range;

use super::search::first;
use crate::predicates::Point2;
use crate::raster::Grid;
use crate::stream::Coordinates;

/// The centres of the cells of a grid, in stored coordinates.
///
/// A centre is brought from the world to stored coordinates once, and rounded; then it is a point of the plane as any other, and
/// vertices stay as they are. So triangles that cover the plane cover each centre, whatever the rounding. Abscissae of columns
/// never decrease and ordinates of rows never increase, because no step of their computation turns back.
#[derive(Debug)]
pub(super) struct Centers {
    grid: Grid,
    scale: Point2,
    offset: Point2,
}

impl Centers {
    pub(super) fn new(grid: Grid, coordinates: &Coordinates) -> Centers {
        let (scale, offset) = match coordinates {
            Coordinates::F64 => ([1.0; 2], [0.0; 2]),
            Coordinates::I32 { scale, offset } => ([scale[0], scale[1]], [offset[0], offset[1]]),
        };
        Centers { grid, scale, offset }
    }

    /// The abscissa of a column.
    #[inline]
    pub(super) fn x(&self, column: u32) -> f64 {
        (self.grid.x_of(column) - self.offset[0]) / self.scale[0]
    }

    /// The ordinate of a row.
    #[inline]
    pub(super) fn y(&self, row: u32) -> f64 {
        (self.grid.y_of(row) - self.offset[1]) / self.scale[1]
    }

    /// About which column has an abscissa.
    #[inline]
    pub(super) fn column_near(&self, x: f64) -> f64 {
        (x * self.scale[0] + self.offset[0] - self.grid.left) / self.grid.step - 0.5
    }

    /// The columns with abscissae from one to another, both included.
    pub(super) fn columns(&self, [from, to]: [f64; 2]) -> Range<u32> {
        let start = first(0..self.grid.columns, self.column_near(from), |column| self.x(column) >= from);
        start..first(start..self.grid.columns, self.column_near(to), |column| self.x(column) > to)
    }

    /// The rows with ordinates from one to another, both included.
    pub(super) fn rows(&self, [from, to]: [f64; 2]) -> Range<u32> {
        let near = |y: f64| (self.grid.top - (y * self.scale[1] + self.offset[1])) / self.grid.step - 0.5;
        let start = first(0..self.grid.rows, near(to), |row| self.y(row) <= to);
        start..first(start..self.grid.rows, near(from), |row| self.y(row) < from)
    }

    /// A gradient by stored coordinates, by those of the world.
    pub(super) fn gradient_to_world(&self, gradient: Point2) -> Point2 {
        [0, 1].map(|axis| gradient[axis] / self.scale[axis])
    }
}

//! Grids that are oblique in the world.

use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::cells4::Point4;

/// Where an oblique grid lies in the world: `world = origin + x * axes[0] + y * axes[1] + z * axes[2]`, where
/// x, y and z are distances from the first sample along the axes of the grid.
///
/// The axes are perpendicular and of length 1, up to the rounding of the file. So the grid and the world
/// have the same Delaunay diagram, and coordinates along the axes of the grid need no rounding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orientation {
    /// The first sample, in the world.
    pub origin: Point,
    /// The directions of the axes of the grid in the world.
    pub axes: [Point; 3],
}

impl Orientation {
    /// The place in the world of a place in the grid.
    pub fn to_world(&self, [x, y, z]: Point) -> Point {
        let [a, b, c] = &self.axes;
        [0, 1, 2].map(|i| self.origin[i] + x * a[i] + y * b[i] + z * c[i])
    }

    /// The place in the grid of a place in the world (Cramer's rule).
    pub fn to_grid(&self, place: Point) -> Point {
        let [a, b, c] = self.axes;
        let offset = [0, 1, 2].map(|i| place[i] - self.origin[i]);
        let volume = determinant([a, b, c]);
        [[offset, b, c], [a, offset, c], [a, b, offset]].map(|columns| determinant(columns) / volume)
    }

    /// As [`Orientation::to_world`]; the time stays.
    pub fn point_to_world(&self, [x, y, z, t]: Point4) -> Point4 {
        let [x, y, z] = self.to_world([x, y, z]);
        [x, y, z, t]
    }

    /// As [`Orientation::to_grid`]; the time stays.
    pub fn point_to_grid(&self, [x, y, z, t]: Point4) -> Point4 {
        let [x, y, z] = self.to_grid([x, y, z]);
        [x, y, z, t]
    }

    /// Whether the axes of the grid are left-handed in the world: then signed volumes change their sign.
    pub fn is_mirrored(&self) -> bool {
        determinant(self.axes) < 0.0
    }
}

fn determinant([a, b, c]: [Point; 3]) -> f64 {
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}

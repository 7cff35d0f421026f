//! The place of a picture in the world.

use spmesh_delaunay::predicates::Point2;

/// The map from a picture to world coordinates: `x = left + unit * across`, `y = top - unit * down`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// The abscissa of the picture's left side. Units: those of the world.
    pub left: f64,
    /// The ordinate of the picture's upper side. Units: those of the world.
    pub top: f64,
    /// World units for one length of the picture.
    pub unit: f64,
}

impl Frame {
    /// The place in the picture of a place in the world: across and down.
    pub fn place(&self, [x, y]: Point2) -> Point2 {
        [(x - self.left) / self.unit, (self.top - y) / self.unit]
    }

    /// The place in the world of a place in the picture.
    pub fn world(&self, [across, down]: Point2) -> Point2 {
        [self.left + self.unit * across, self.top - self.unit * down]
    }
}

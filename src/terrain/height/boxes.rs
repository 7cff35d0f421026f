//! Boxes in the plane.

use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::points::Point2;

/// A closed box in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Box2 {
    pub(crate) min: Point2,
    pub(crate) max: Point2,
}

impl Box2 {
    pub(crate) const NONE: Box2 = Box2 { min: [f64::INFINITY; 2], max: [f64::NEG_INFINITY; 2] };

    /// The box of some points, which are no NaN.
    #[inline]
    pub(crate) fn of<'p>(points: impl IntoIterator<Item = &'p Point>) -> Box2 {
        let Box2 { min: [mut left, mut low], max: [mut right, mut high] } = Box2::NONE;
        // A minimum that heeds NaN, as that of `f64`, takes longer.
        for &[x, y, _] in points {
            left = if x < left { x } else { left };
            right = if x > right { x } else { right };
            low = if y < low { y } else { low };
            high = if y > high { y } else { high };
        }
        Box2 { min: [left, low], max: [right, high] }
    }

    /// The least box around both.
    pub(crate) fn with(&self, other: &Box2) -> Box2 {
        Box2 {
            min: [0, 1].map(|axis| self.min[axis].min(other.min[axis])),
            max: [0, 1].map(|axis| self.max[axis].max(other.max[axis])),
        }
    }

    /// Whether a point is inside or on the border.
    #[inline]
    pub(super) fn contains(&self, &[x, y, _]: &Point) -> bool {
        (self.min[0] <= x) & (x <= self.max[0]) & (self.min[1] <= y) & (y <= self.max[1])
    }

    /// Whether both have a place in common.
    pub(super) fn meets(&self, other: &Box2) -> bool {
        (0..2).all(|axis| self.min[axis] <= other.max[axis] && other.min[axis] <= self.max[axis])
    }

    /// Whether its sides have lengths, which are finite.
    pub(crate) fn has_sides(&self) -> bool {
        (0..2).all(|axis| (self.max[axis] - self.min[axis]).is_finite())
    }

    /// Length of its longer side.
    #[inline]
    pub(super) fn longer_side(&self) -> f64 {
        (self.max[0] - self.min[0]).max(self.max[1] - self.min[1])
    }

    /// The squared distance of a point from the box.
    pub(super) fn distance2(&self, at: &Point) -> f64 {
        let [x, y] = [0, 1].map(|axis| (self.min[axis] - at[axis]).max(at[axis] - self.max[axis]).max(0.0));
        x * x + y * y
    }
}

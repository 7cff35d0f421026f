//! Axis-parallel boxes: the closed bounding box of points, and the half-open region of a tile.

use super::points::Point2;

/// A point in stored coordinates: x, y and z. Two-dimensional points without an elevation have z = 0.
///
/// Streams of integer coordinates carry integer values; [`crate::Coordinates`] tells how
/// they map to the world.
pub type Point = [f64; 3];

/// Closed bounding box of at least one point, in stored coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Smallest coordinate per axis.
    pub min: Point,
    /// Largest coordinate per axis.
    pub max: Point,
}

impl Bounds {
    /// The bounding box of a single point.
    #[inline]
    pub fn of_point(point: Point) -> Self {
        Bounds { min: point, max: point }
    }

    /// The bounding box of `points`, or `None` if there are none.
    pub fn of_points(points: &[Point]) -> Option<Self> {
        let (&first, rest) = points.split_first()?;
        let mut bounds = Bounds::of_point(first);
        rest.iter().for_each(|&point| bounds.extend(point));
        Some(bounds)
    }

    /// Grows the box so that it contains `point`.
    #[inline]
    pub fn extend(&mut self, point: Point) {
        for (axis, value) in point.into_iter().enumerate() {
            self.min[axis] = self.min[axis].min(value);
            self.max[axis] = self.max[axis].max(value);
        }
    }

    /// The smallest box that contains both.
    #[inline]
    #[must_use]
    pub fn union(mut self, other: Bounds) -> Self {
        self.extend(other.min);
        self.extend(other.max);
        self
    }

    /// The smallest box that holds all points of this box in a region; `None` if there are none. `are_whole`
    /// says that coordinates are integers.
    pub fn within<const D: usize>(&self, region: &Region<D>, are_whole: bool) -> Option<Bounds> {
        let mut bounds = *self;
        for axis in 0..D {
            // The first coordinate inside the region, and the last one.
            let (min, max) = (region.min[axis], region.max[axis]);
            let (min, max) = if are_whole { (min.ceil(), max.ceil() - 1.0) } else { (min, max.next_down()) };
            bounds.min[axis] = bounds.min[axis].max(min);
            bounds.max[axis] = bounds.max[axis].min(max);
        }
        (0..D).all(|axis| bounds.min[axis] <= bounds.max[axis]).then_some(bounds)
    }

    /// The box over a rectangle of the plane: infinitely high, and infinitely deep.
    pub fn over(min: Point2, max: Point2) -> Self {
        let ([x, y], [max_x, max_y]) = (min, max);
        Bounds { min: [x, y, f64::NEG_INFINITY], max: [max_x, max_y, f64::INFINITY] }
    }

    /// Whether two closed boxes have a point in common.
    pub fn meets(&self, other: &Bounds) -> bool {
        (0..3).all(|axis| self.min[axis] <= other.max[axis] && other.min[axis] <= self.max[axis])
    }

    /// Whether `point` lies in the closed box.
    #[inline]
    pub fn contains(&self, point: Point) -> bool {
        (0..3).all(|axis| self.min[axis] <= point[axis] && point[axis] <= self.max[axis])
    }
}

/// A half-open box `[min, max)` in the plane, or in space with `D = 3`, so that a point on a common border
/// belongs to one tile only. Sides may be infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region<const D: usize = 2> {
    /// Included lower sides.
    pub min: [f64; D],
    /// Excluded upper sides.
    pub max: [f64; D],
}

impl Region {
    /// The whole plane.
    pub const PLANE: Region = Region::EVERYTHING;
}

impl Region<3> {
    /// The region with the given lower and upper sides along the first axes, unbounded along the others.
    pub fn of_sides(lower: &[f64], upper: &[f64]) -> Self {
        let mut region = Region::EVERYTHING;
        region.min.iter_mut().zip(lower).for_each(|(side, &given)| *side = given);
        region.max.iter_mut().zip(upper).for_each(|(side, &given)| *side = given);
        region
    }
}

impl<const D: usize> Region<D> {
    /// The region without bounds.
    pub const EVERYTHING: Region<D> = Region { min: [f64::NEG_INFINITY; D], max: [f64::INFINITY; D] };

    /// The region between two corners; only their first D coordinates count.
    pub fn between(min: Point, max: Point) -> Self {
        Region { min: std::array::from_fn(|axis| min[axis]), max: std::array::from_fn(|axis| max[axis]) }
    }

    /// The same region in space, unbounded along the axes that it does not have.
    #[inline]
    pub fn in_space(&self) -> Region<3> {
        Region::of_sides(&self.min, &self.max)
    }

    /// The lower sides, and the upper ones.
    #[inline]
    pub fn sides(&self) -> [[f64; D]; 2] {
        [self.min, self.max]
    }

    /// Whether the first D coordinates of `point` lie in the half-open box.
    #[inline]
    pub fn contains(&self, point: Point) -> bool {
        (0..D).all(|axis| self.min[axis] <= point[axis] && point[axis] < self.max[axis])
    }

    /// Whether no point of `inner` lies outside of this box.
    #[inline]
    pub fn covers(&self, inner: &Self) -> bool {
        (0..D).all(|axis| self.min[axis] <= inner.min[axis] && inner.max[axis] <= self.max[axis])
    }

    /// Whether the two half-open boxes have a point in common.
    #[inline]
    pub fn overlaps(&self, other: &Self) -> bool {
        (0..D).all(|axis| self.min[axis] < other.max[axis] && other.min[axis] < self.max[axis])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_are_cut_to_what_a_region_can_hold() {
        let all = Bounds { min: [-5.0, 0.0, 1.0], max: [5.0, 9.0, 2.0] };
        assert_eq!(all.within(&Region::PLANE, true), Some(all));
        let part = Region { min: [-0.5, f64::NEG_INFINITY], max: [3.0, 4.25] };
        let expected = Bounds { min: [0.0, 0.0, 1.0], max: [2.0, 4.0, 2.0] };
        assert_eq!(all.within(&part, true), Some(expected));
        let expected = Bounds { min: [-0.5, 0.0, 1.0], max: [3f64.next_down(), 4.25f64.next_down(), 2.0] };
        assert_eq!(all.within(&part, false), Some(expected));
        let beside = Region { min: [5.0, f64::NEG_INFINITY], max: [f64::INFINITY; 2] };
        assert_eq!(all.within(&beside, true).map(|found| found.min[0]), Some(5.0));
        let between = Region { min: [0.25, 0.0], max: [0.75, 9.0] };
        assert_eq!(all.within(&between, true), None);
    }
}

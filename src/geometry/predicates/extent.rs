//! The properties of a chunk of points that the choice of arithmetic depends on.

/// Bounding box of a chunk of points of the plane, or of space with `D = 3`, and which numbers its
/// coordinates are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent<const D: usize = 2> {
    /// Least coordinate of each axis; `INFINITY` if there is no point.
    pub lower: [f64; D],
    /// Greatest coordinate of each axis; `NEG_INFINITY` if there is no point.
    pub upper: [f64; D],
    /// Every coordinate is an integer, of a magnitude up to 2^63.
    pub integral: bool,
    /// Least magnitude among the coordinates that are not zero; `INFINITY` if all are.
    pub least_magnitude: f64,
    /// Every coordinate is finite; where it is not, the other fields mean nothing.
    pub finite: bool,
}

impl<const D: usize> Extent<D> {
    /// Extent of `points`. Cost: one pass.
    #[must_use]
    pub fn of(points: &[[f64; D]]) -> Extent<D> {
        Extent::of_each(points.iter().copied())
    }

    /// Extent of all points that `points` gives.
    #[must_use]
    pub fn of_each(points: impl Iterator<Item = [f64; D]>) -> Extent<D> {
        let mut extent = Extent {
            lower: [f64::INFINITY; D],
            upper: [f64::NEG_INFINITY; D],
            integral: true,
            least_magnitude: f64::INFINITY,
            finite: true,
        };
        for point in points {
            for (axis, &coordinate) in point.iter().enumerate() {
                extent.lower[axis] = extent.lower[axis].min(coordinate);
                extent.upper[axis] = extent.upper[axis].max(coordinate);
                let magnitude = if coordinate == 0.0 { f64::INFINITY } else { coordinate.abs() };
                extent.least_magnitude = extent.least_magnitude.min(magnitude);
                extent.integral &= coordinate as i64 as f64 == coordinate;
                extent.finite &= coordinate.is_finite();
            }
        }
        extent
    }

    /// Greatest difference of two coordinates of the same axis, rounded; may be infinite. Zero if there is no
    /// point.
    #[must_use]
    pub fn max_difference(&self) -> f64 {
        (0..D).fold(0.0, |greatest, axis| greatest.max(self.upper[axis] - self.lower[axis]))
    }

    /// Greatest magnitude of a coordinate. Zero if there is no point.
    #[must_use]
    pub fn greatest_magnitude(&self) -> f64 {
        if self.lower[0] > self.upper[0] {
            return 0.0;
        }
        self.lower.iter().chain(&self.upper).fold(0.0, |greatest, bound| bound.abs().max(greatest))
    }
}

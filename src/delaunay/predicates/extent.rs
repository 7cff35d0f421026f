//! The properties of a chunk of points that the choice of arithmetic depends on.

use crate::parallel;
use std::convert::Infallible;
use std::num::NonZeroUsize;

/// Points that a thread looks at in one go.
const PIECE: usize = 1 << 16;

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
    pub fn of(points: &[[f64; D]]) -> Extent<D> {
        Extent::of_each(points.iter().copied())
    }

    /// The same on so many threads.
    pub fn on(threads: NonZeroUsize, points: &[[f64; D]]) -> Extent<D> {
        let work = |piece| Ok::<_, Infallible>(Extent::of(piece));
        let Ok(extents) = parallel::map(threads, points.chunks(PIECE), work);
        extents.into_iter().fold(Extent::of(&[]), Extent::and)
    }

    /// Extent of the points of both.
    fn and(self, other: Extent<D>) -> Extent<D> {
        Extent {
            lower: std::array::from_fn(|axis| self.lower[axis].min(other.lower[axis])),
            upper: std::array::from_fn(|axis| self.upper[axis].max(other.upper[axis])),
            integral: self.integral & other.integral,
            least_magnitude: self.least_magnitude.min(other.least_magnitude),
            finite: self.finite & other.finite,
        }
    }

    /// Extent of all points that `points` gives.
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
    pub fn max_difference(&self) -> f64 {
        (0..D).fold(0.0, |greatest, axis| greatest.max(self.upper[axis] - self.lower[axis]))
    }

    /// Greatest magnitude of a coordinate. Zero if there is no point.
    pub fn greatest_magnitude(&self) -> f64 {
        if self.lower[0] > self.upper[0] {
            return 0.0;
        }
        self.lower.iter().chain(&self.upper).fold(0.0, |greatest, bound| bound.abs().max(greatest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_make_no_difference() {
        let point = |i: usize| [i as f64 - 70_000.0, (i % 7) as f64 * 0.5];
        let mut points: Vec<[f64; 2]> = (0..3 * PIECE + 5).map(point).collect();
        for bad in [1.0, f64::NAN, f64::INFINITY] {
            points[PIECE + 1][0] = bad;
            let (one, three) = (Extent::of(&points), Extent::on(NonZeroUsize::new(3).unwrap(), &points));
            assert_eq!(one, three);
        }
        let none = Extent::<2>::on(NonZeroUsize::MIN, &[]);
        assert_eq!(none, Extent::of(&[]));
    }
}

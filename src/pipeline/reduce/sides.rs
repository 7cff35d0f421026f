//! The sides of the box of all points: nothing lies beyond them.

use spmesh_stream::model::bounds::Bounds;

/// The box of all points of the input; NaN where it is not known.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sides<const D: usize> {
    min: [f64; D],
    max: [f64; D],
}

impl<const D: usize> Sides<D> {
    pub(super) const UNKNOWN: Self = Sides { min: [f64::NAN; D], max: [f64::NAN; D] };

    /// The sides of `bounds`, which must contain all points that any run over this input sees.
    pub(super) fn of(bounds: Bounds) -> Self {
        Sides { min: std::array::from_fn(|i| bounds.min[i]), max: std::array::from_fn(|i| bounds.max[i]) }
    }

    pub(super) fn are_known(&self) -> bool {
        !self.min.iter().any(|side| side.is_nan())
    }

    /// Whether all `points` lie on one side. If they are the corners of a facet of the hull, no other point
    /// lies beyond it, so that its infinite simplex is final: points on a grid, or in rows along an axis,
    /// have many.
    pub(super) fn hold(&self, points: impl Iterator<Item = [f64; D]> + Clone) -> bool {
        let all_at = |axis: usize, side: f64| points.clone().all(|point| point[axis] == side);
        (0..D).any(|axis| all_at(axis, self.min[axis]) || all_at(axis, self.max[axis]))
    }

    /// Whether two sides coincide, so that all points lie on one line, or in one plane.
    pub(super) fn coincide(&self) -> bool {
        (0..D).any(|axis| self.min[axis] == self.max[axis])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn facets_lie_on_one_side_or_on_none() {
        let sides = Sides::<2>::of(Bounds { min: [0.0, 0.0, 5.0], max: [4.0, 1.0, 5.0] });
        let hold = |points: [[f64; 2]; 2]| sides.hold(points.into_iter());
        assert!(hold([[1.0, 1.0], [3.0, 1.0]]) && hold([[0.0, 0.25], [-0.0, 0.5]]));
        assert!(!hold([[0.0, 0.5], [1.0, 1.0]]) && !hold([[1.0, 0.5], [3.0, 0.5]]));
        assert!(!sides.coincide(), "elevations do not count");
        assert!(Sides::<2>::of(Bounds { min: [0.0, 1.0, 0.0], max: [4.0, 1.0, 5.0] }).coincide());
        assert!(!Sides::<2>::UNKNOWN.hold([[0.0; 2]].into_iter()) && !Sides::<2>::UNKNOWN.coincide());
    }
}

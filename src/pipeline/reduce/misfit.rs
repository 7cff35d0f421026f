//! What of damaged partial results does not fit together.

use super::residual::Residual;
use spmesh_base::error::Error;

/// What of the points does not fit, after an error: numbers of points or of a wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Misfit {
    Point(u32),
    Points([u32; 2]),
    Wall(usize),
}

/// The error of two points at one place.
pub(super) fn overlap<const D: usize>(points: &Residual<D>, point: u32, vertex: u32) -> Error {
    let [a, b] = [point, vertex].map(|i| points.point(i as usize));
    Error::malformed(format!(
        "point {a:?} coincides with {b:?} of another cell or tile (stored coordinates): regions overlap"
    ))
}

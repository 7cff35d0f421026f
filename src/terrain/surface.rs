//! Triangles with elevations: the streams that have them, and the triangles that are left out or refused.

use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::{Point2, Predicates2, Sign};
pub(crate) use spmesh_stream::check_surface as check_input;

/// Whether corners are counterclockwise; false if they are collinear.
///
/// # Errors
/// Malformed, if they are clockwise.
pub fn is_counterclockwise([a, b, c]: [Point2; 3], predicates: &mut impl Predicates2) -> Result<bool> {
    match predicates.orient2d(a, b, c) {
        Sign::Positive => Ok(true),
        Sign::Zero => Ok(false),
        Sign::Negative => Err(Error::malformed(format!(
            "the triangle with corners {a:?}, {b:?}, {c:?} (stored coordinates) is clockwise"
        ))),
    }
}

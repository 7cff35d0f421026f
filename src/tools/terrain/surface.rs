//! Triangles with elevations: the streams that have them, and the triangles that are left out or refused.

use spmesh_core::error::{Error, Result};
use spmesh_geometry::predicates::{Point2, Predicates2, Sign};
use spmesh_stream::{Header, Kind};

/// Checks that a stream is a triangle mesh; it must have elevations if they are needed.
///
/// # Errors
/// Usage, if it is not.
pub(crate) fn check_input(header: &Header, needs_elevation: bool) -> Result<()> {
    let what = match header.kind {
        Kind::TriangleMesh if header.has_elevation || !needs_elevation => return Ok(()),
        Kind::TriangleMesh => "vertices have no elevation: give points x y z to spfinalize".to_string(),
        Kind::PartialTriangleMesh => {
            "this is a partial triangle mesh: finish it with spdelaunay2d --merge".to_string()
        }
        Kind::Points => "these are points: triangulate them with spdelaunay2d".to_string(),
        kind => format!("this is a stream of kind {}, expected a triangle mesh", kind.name()),
    };
    Err(Error::usage(what))
}

/// Whether corners are counterclockwise; false if they are collinear.
///
/// # Errors
/// [`spmesh_core::error::ErrorKind::Malformed`], if they are clockwise.
pub(crate) fn is_counterclockwise([a, b, c]: [Point2; 3], predicates: &mut impl Predicates2) -> Result<bool> {
    match predicates.orient2d(a, b, c) {
        Sign::Positive => Ok(true),
        Sign::Zero => Ok(false),
        Sign::Negative => Err(Error::malformed(format!(
            "the triangle with corners {a:?}, {b:?}, {c:?} (stored coordinates) is clockwise"
        ))),
    }
}

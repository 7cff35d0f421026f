//! What tools that draw or measure a surface need of a stream.

use super::header::Header;
use super::kind::Kind;
use spmesh_base::error::{Error, Result};

/// Checks that a stream is a triangle mesh; it must have elevations if they are needed.
///
/// # Errors
/// Usage, if it is not.
pub fn check_surface(header: &Header, needs_elevation: bool) -> Result<()> {
    let what = match header.kind {
        Kind::TriangleMesh if header.has_elevation || !needs_elevation => return Ok(()),
        // An input without points may not tell whether they would have elevations.
        Kind::TriangleMesh if header.points == Some(0) => return Ok(()),
        Kind::TriangleMesh => "vertices have no elevation: give points x y z to spfinalize".to_string(),
        Kind::PartialTriangleMesh => {
            "this is a partial triangle mesh: finish it with spdelaunay2d --merge".to_string()
        }
        Kind::Points => "these are points: triangulate them with spdelaunay2d".to_string(),
        kind => format!("this is a stream of kind {}, expected a triangle mesh", kind.name()),
    };
    Err(Error::usage(what))
}

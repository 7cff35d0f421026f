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

/// Refuses a part of a mesh alone where a program looks at more than one triangle at a time: what lies beyond
/// the border of the part would count as outside of the mesh. `beyond` is what looks there, such as a flag;
/// nothing does if it is `None`.
///
/// # Errors
/// Usage, if the stream is a part.
pub fn check_part(header: &Header, beyond: Option<&str>) -> Result<()> {
    let Some(what) = beyond.filter(|_| header.part.is_some()) else { return Ok(()) };
    Err(Error::usage(format!(
        "this is a part of a mesh, and {what} needs the triangles around it: give the manifest that spnode \
         collect writes, of which only the parts in a window are read (--bounds, --mask, or the box of the \
         points)"
    )))
}

//! Triangles with elevations: the streams that have them, and the triangles that are left out or refused.

use spmesh_core::error::{Error, Result};
use spmesh_geometry::predicates::{Point2, Predicates2, Sign};
use spmesh_stream::{Coordinates, Header, Kind};

/// Relative tolerance, so that edges exactly at the limit pass however their length is rounded.
const LENGTH_TOLERANCE: f64 = 1e-12;

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

/// The limit on the edges of triangles that are drawn.
#[derive(Debug)]
pub(crate) struct LongEdges {
    scale: Point2,
    longest: f64,
}

impl LongEdges {
    /// Edges longer than `kill` are too long; none are if it is `None`. Units: those of the world.
    pub(crate) fn new(kill: Option<f64>, coordinates: &Coordinates) -> LongEdges {
        let scale = match coordinates {
            Coordinates::F64 => [1.0; 2],
            Coordinates::I32 { scale: [x, y, _], .. } => [*x, *y],
        };
        LongEdges { scale, longest: kill.map_or(f64::INFINITY, |length| length * (1.0 + LENGTH_TOLERANCE)) }
    }

    /// Whether a triangle has an edge that is too long; its corners are in stored coordinates.
    pub(crate) fn are_in(&self, [a, b, c]: [Point2; 3]) -> bool {
        let is_long = |p, q| self.length(p, q) > self.longest;
        self.longest.is_finite() && (is_long(a, b) || is_long(b, c) || is_long(c, a))
    }

    /// The length of an edge. Units: those of the world.
    fn length(&self, a: Point2, b: Point2) -> f64 {
        let [x, y] = [0, 1].map(|axis| (b[axis] - a[axis]) * self.scale[axis]);
        x.hypot(y)
    }
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

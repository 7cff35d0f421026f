//! The tetrahedron that insertion starts with.

use super::check;
use super::sphere::orientation;
use spmesh_delaunay::delaunay3::Vertex;
use spmesh_delaunay::order::Insertions;
use spmesh_delaunay::predicates::Sign;

/// Four vertices, positively oriented for exact arithmetic and for rounded arithmetic; none if all are in a
/// plane.
///
/// The first to be inserted, the second, the first that is not collinear with them, the first after that that
/// is not coplanar.
pub(super) fn first_tetrahedron(vertices: &[Vertex], mut insertions: Insertions) -> Option<[u32; 4]> {
    let at = |v: u32| vertices[v as usize].at;
    let (a, b) = (insertions.next()?, insertions.next()?);
    let c = insertions.find(|&v| !check::are_collinear(at(a), at(b), at(v)))?;
    let is_positive = |a, b, c, d| {
        check::orient3d(at(a), at(b), at(c), at(d)) == Sign::Positive
            && orientation(at(a), at(b), at(c), at(d)) > 0.0
    };
    insertions.flat_map(|d| [[a, b, c, d], [b, a, c, d]]).find(|&[a, b, c, d]| is_positive(a, b, c, d))
}

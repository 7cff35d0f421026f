//! Points without those that coincide with an earlier one.

use spmesh_delaunay::delaunay2::distinct;
use spmesh_delaunay::predicates::Point2;

/// The first point at each place.
pub(super) fn without_copies(places: &[Point2]) -> Vec<Point2> {
    let firsts = distinct(places);
    let own = places.iter().zip(0..).zip(firsts).filter(|((_, id), first)| id == first);
    own.map(|((&place, _), _)| place).collect()
}

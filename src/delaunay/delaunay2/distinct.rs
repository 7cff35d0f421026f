//! Points with equal coordinates, found without a triangulation.

use crate::order::{Curve, SpatialOrder};
use crate::predicates::{Extent, Point2, lexicographic};

/// For each point, the least index of a point with equal coordinates: its own, if it is the first.
///
/// Domain: finite coordinates; `-0.0` equals `0.0`. Cost: a sort.
pub fn distinct(points: &[Point2]) -> Vec<u32> {
    let mut order = SpatialOrder::default();
    let mut representatives = vec![0; points.len()];
    let mut first: Option<u32> = None;
    for index in order.sort(points, &Extent::of(points), Curve::Hilbert) {
        let representative = match first {
            Some(first) if lexicographic(points[first as usize], points[index as usize]).is_eq() => first,
            _ => index,
        };
        representatives[index as usize] = representative;
        first = Some(representative);
    }
    representatives
}

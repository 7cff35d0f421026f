//! Points with equal coordinates, found without a triangulation.

use crate::order::MortonOrder;
use crate::predicates::{Extent, Point2, lexicographic};

/// For each point, the least index of a point with equal coordinates: its own, if it is the first.
///
/// Domain: finite coordinates; `-0.0` equals `0.0`. Cost: a sort.
#[must_use]
pub fn distinct(points: &[Point2]) -> Vec<u32> {
    let mut order = MortonOrder::default();
    let mut representatives = vec![0; points.len()];
    let mut first: Option<u32> = None;
    for item in order.sort(points, &Extent::of(points)) {
        let point = points[item.index as usize];
        let representative = match first {
            Some(index) if lexicographic(points[index as usize], point).is_eq() => index,
            _ => item.index,
        };
        representatives[item.index as usize] = representative;
        first = Some(representative);
    }
    representatives
}

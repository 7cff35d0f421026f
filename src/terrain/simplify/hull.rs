//! The corners of the convex hull.

use spmesh_delaunay::predicates::{FiniteFloatPredicates, Point2, Predicates2, Sign, lexicographic};
use spmesh_stream::model::bounds::Point;

/// The corners of the hull of points, counterclockwise from the first in lexicographic order; points amid its
/// edges are none (Andrew, 1979). Fewer than three if all points are on a line.
pub(super) fn corners(mut points: Vec<Point>) -> Vec<Point> {
    let place = |&[x, y, _]: &Point| -> Point2 { [x, y] };
    points.sort_unstable_by(|a, b| lexicographic(place(a), place(b)));
    points.dedup_by(|a, b| place(a) == place(b));
    let mut predicates = FiniteFloatPredicates::default();
    let mut chain = |points: &mut dyn Iterator<Item = Point>| {
        let mut chain: Vec<Point> = Vec::new();
        for point in points {
            while let [.., a, b] = &chain[..]
                && predicates.orient2d(place(a), place(b), place(&point)) != Sign::Positive
            {
                chain.pop();
            }
            chain.push(point);
        }
        // The last point is the first of the other chain.
        chain.pop();
        chain
    };
    let mut corners = chain(&mut points.iter().copied());
    corners.append(&mut chain(&mut points.iter().rev().copied()));
    if corners.is_empty() { points } else { corners }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_strict() {
        let grid = (0..25).map(|i| [f64::from(i % 5), f64::from(i / 5), 0.0]).collect();
        assert_eq!(corners(grid).len(), 4);
        let line: Vec<Point> = (0..9).map(|i| [f64::from(i), f64::from(2 * i), 1.0]).collect();
        assert_eq!(corners(line.clone()).len(), 2);
        for few in 0..2 {
            assert_eq!(corners(line[..few].to_vec()), line[..few]);
        }
        assert_eq!(corners(vec![[1.0, 1.0, 0.0]; 3]).len(), 1);
    }
}

//! The nearest of many points.

use super::shares::length;
use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::vector::difference;

/// Points as a k-d tree without pointers: the middle point of a slice divides the others, at each level along
/// the next axis.
///
/// Source: Bentley, "Multidimensional binary search trees used for associative searching", 1975.
pub(super) struct Nearest(Vec<Point3>);

impl Nearest {
    /// Cost: O(n log n).
    pub(super) fn new(mut points: Vec<Point3>) -> Nearest {
        arrange(&mut points, 0);
        Nearest(points)
    }

    /// Distance of the nearest point; `None` if there are no points.
    pub(super) fn distance(&self, from: Point3) -> Option<f64> {
        let mut best = f64::INFINITY;
        search(&self.0, 0, from, &mut best);
        (!self.0.is_empty()).then_some(best)
    }
}

fn arrange(points: &mut [Point3], axis: usize) {
    if points.len() < 2 {
        return;
    }
    let middle = points.len() / 2;
    points.select_nth_unstable_by(middle, |p, q| p[axis].total_cmp(&q[axis]));
    let (lower, upper) = points.split_at_mut(middle);
    arrange(lower, (axis + 1) % 3);
    arrange(&mut upper[1..], (axis + 1) % 3);
}

fn search(points: &[Point3], axis: usize, from: Point3, best: &mut f64) {
    if points.is_empty() {
        return;
    }
    let (lower, upper) = points.split_at(points.len() / 2);
    *best = best.min(length(difference(upper[0], from)));
    let beyond = from[axis] - upper[0][axis];
    let (near, far) = if beyond < 0.0 { (lower, &upper[1..]) } else { (&upper[1..], lower) };
    search(near, (axis + 1) % 3, from, best);
    if beyond.abs() < *best {
        search(far, (axis + 1) % 3, from, best);
    }
}

//! Convex polygons cut by half-planes, in plain arithmetic.

use spmesh_delaunay::predicates::Point2;

/// The corners of a convex polygon, counterclockwise.
pub(super) type Polygon = Vec<Point2>;

/// Twice the signed area of a triangle.
#[inline]
pub(super) fn twice_area(a: Point2, b: Point2, c: Point2) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

pub(super) fn area(polygon: &[Point2]) -> f64 {
    let Some((&first, rest)) = polygon.split_first() else { return 0.0 };
    0.5 * rest.windows(2).map(|edge| twice_area(first, edge[0], edge[1])).sum::<f64>()
}

/// The squared distance of two corners.
#[inline]
pub(super) fn square_of_side(p: Point2, q: Point2) -> f64 {
    (q[0] - p[0]).powi(2) + (q[1] - p[1]).powi(2)
}

/// Buffers for intersections.
#[derive(Debug, Default)]
pub(super) struct Clipper {
    current: Polygon,
    next: Polygon,
}

impl Clipper {
    /// The part of a convex polygon that is not to the left of any of some lines.
    pub(super) fn right_of(&mut self, subject: &[Point2], lines: &[[Point2; 2]]) -> &[Point2] {
        self.current.clear();
        self.current.extend_from_slice(subject);
        lines.iter().for_each(|&[p, q]| self.keep_left(q, p));
        &self.current
    }

    /// Keeps the part that is not to the right of a line (Sutherland and Hodgman, 1974).
    fn keep_left(&mut self, p: Point2, q: Point2) {
        self.next.clear();
        let Some(&last) = self.current.last() else { return };
        let (mut a, mut at_a) = (last, twice_area(p, q, last));
        for &b in &self.current {
            let at_b = twice_area(p, q, b);
            if (at_a > 0.0 && at_b < 0.0) || (at_a < 0.0 && at_b > 0.0) {
                let share = at_a / (at_a - at_b);
                self.next.push([0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis])));
            }
            if at_b >= 0.0 {
                self.next.push(b);
            }
            (a, at_a) = (b, at_b);
        }
        std::mem::swap(&mut self.current, &mut self.next);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_part_right_of_lines_is_kept() {
        let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        let mut clipper = Clipper::default();
        let mut right_of = |lines: &[[Point2; 2]]| area(clipper.right_of(&square, lines));
        assert_eq!(right_of(&[]), 4.0);
        assert_eq!(right_of(&[[[1.5, 0.0], [1.5, 1.0]]]), 1.0);
        assert_eq!(right_of(&[[[1.5, 1.0], [1.5, 0.0]], [[0.0, 1.0], [2.0, 1.0]]]), 1.5);
        assert_eq!(right_of(&[[[2.0, 0.0], [2.0, 1.0]]]), 0.0);
    }
}

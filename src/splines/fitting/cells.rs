//! The cells into which lines divide a convex polygon.

use super::polygon::{self, Polygon, twice_area};
use spmesh_delaunay::predicates::Point2;

/// Parts smaller than this share of the whole polygon stay with their neighbour: where several lines meet in
/// one point, rounding leaves such parts between them.
const SHARE_MIN: f64 = 1e-14;

/// Calls `visit` with each cell of a convex polygon, and with the lines that the cell is to the left of. All
/// cells have an area above zero.
///
/// Cost: at most 1 + m (m + 1) / 2 cells for m lines that cross the polygon.
pub(super) fn for_each_cell(
    polygon: Polygon,
    lines: &[[Point2; 2]],
    visit: &mut impl FnMut(&Polygon, &[bool]),
) {
    let size = polygon::area(&polygon);
    if size > 0.0 {
        let mut is_left = Vec::with_capacity(lines.len());
        Division { lines, least: SHARE_MIN * size, visit }.divide(polygon, &mut is_left);
    }
}

struct Division<'a, V> {
    lines: &'a [[Point2; 2]],
    /// The least area of a part.
    least: f64,
    visit: &'a mut V,
}

impl<V: FnMut(&Polygon, &[bool])> Division<'_, V> {
    /// Visits the cells of a polygon whose sides of the first lines are known.
    fn divide(&mut self, polygon: Polygon, is_left: &mut Vec<bool>) {
        let known = is_left.len();
        for &[p, q] in &self.lines[known..] {
            let extremes = polygon.iter().map(|&corner| twice_area(p, q, corner));
            let [low, high] = extremes.fold([0f64; 2], |[low, high], at| [low.min(at), high.max(at)]);
            if low == 0.0 || high == 0.0 {
                is_left.push(high >= -low);
                continue;
            }
            let heights: Vec<f64> = polygon.iter().map(|&corner| twice_area(p, q, corner)).collect();
            let [left, right] = [1.0, -1.0].map(|side| part(&polygon, &heights, side));
            if [&left, &right].into_iter().all(|part| polygon::area(part) > self.least) {
                for (side, part) in [(true, left), (false, right)] {
                    is_left.push(side);
                    self.divide(part, is_left);
                    is_left.pop();
                }
                is_left.truncate(known);
                return;
            }
            is_left.push(high >= -low);
        }
        (self.visit)(&polygon, is_left);
        is_left.truncate(known);
    }
}

/// The part of a convex polygon on one side of a line; `heights` are those of the corners above the line.
fn part(polygon: &[Point2], heights: &[f64], side: f64) -> Polygon {
    let mut kept = Polygon::with_capacity(polygon.len() + 1);
    for (at, (&b, &height)) in polygon.iter().zip(heights).enumerate() {
        let before = (at + polygon.len() - 1) % polygon.len();
        let (a, at_a, at_b) = (polygon[before], side * heights[before], side * height);
        if (at_a > 0.0 && at_b < 0.0) || (at_a < 0.0 && at_b > 0.0) {
            let share = at_a / (at_a - at_b);
            kept.push([0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis])));
        }
        if at_b >= 0.0 {
            kept.push(b);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [Point2; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

    fn cells(lines: &[[Point2; 2]]) -> Vec<(f64, Vec<bool>)> {
        let mut found = Vec::new();
        for_each_cell(SQUARE.to_vec(), lines, &mut |cell, is_left| {
            found.push((polygon::area(cell), is_left.to_vec()));
        });
        found.sort_by(|a, b| a.1.cmp(&b.1));
        found
    }

    #[test]
    fn lines_divide_a_square() {
        assert_eq!(cells(&[]), [(1.0, vec![])]);
        let found =
            cells(&[[[0.25, -9.0], [0.25, 9.0]], [[-1.0, 0.5], [3.0, 0.5]], [[2.0, 0.0], [2.0, 1.0]]]);
        let expected = [
            (0.375, vec![false, false, true]),
            (0.375, vec![false, true, true]),
            (0.125, vec![true, false, true]),
            (0.125, vec![true, true, true]),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn lines_through_one_point_make_no_slivers() {
        // Ten lines through a point inside, some of them twice and in the other direction.
        let ends = |i: u32| {
            let angle = 0.3 * f64::from(i % 7);
            let (x, y) = (angle.cos() / 3.0, angle.sin() / 3.0);
            if i < 7 { [[0.4 - x, 0.7 - y], [0.4 + x, 0.7 + y]] } else { [[0.4 + x, 0.7 + y], [0.4, 0.7]] }
        };
        let found = cells(&(0..10).map(ends).collect::<Vec<_>>());
        assert_eq!(found.len(), 14);
        assert!((found.iter().map(|cell| cell.0).sum::<f64>() - 1.0).abs() < 1e-14);
        assert!(found.iter().all(|cell| cell.0 > 1e-3));
    }
}

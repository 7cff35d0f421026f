//! Rings of water, cut at the box of the points.

use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::{Bounds, Point};

/// The part of a ring inside of a box, as one ring along the box's border; empty if there is none. The first
/// vertex of a ring is also its last.
///
/// Each side of the box cuts in turn (Sutherland and Hodgman 1974). The result may run along a side and back:
/// such parts bound nothing by the even-odd rule. Elevations are interpolated along what is cut.
pub(super) fn cut(ring: &[Point], bounds: &Bounds, coordinates: &Coordinates) -> Vec<Point> {
    let mut ring = ring.to_vec();
    for axis in 0..2 {
        ring = beyond(&ring, axis, bounds.min[axis], 1.0, coordinates);
        ring = beyond(&ring, axis, bounds.max[axis], -1.0, coordinates);
    }
    let turns = ring.windows(2).filter(|ends| ends[0][..2] != ends[1][..2]).count();
    if turns < 3 { Vec::new() } else { ring }
}

/// The part of a ring on one side of a line: where coordinates times `sign` are at least `limit` times it.
fn beyond(ring: &[Point], axis: usize, limit: f64, sign: f64, coordinates: &Coordinates) -> Vec<Point> {
    let is_in = |place: &Point| (place[axis] - limit) * sign >= 0.0;
    let mut kept: Vec<Point> = Vec::new();
    for ends in ring.windows(2) {
        let [from, to] = [ends[0], ends[1]];
        if is_in(&from) {
            kept.push(from);
        }
        if is_in(&from) != is_in(&to) {
            kept.push(crossing(from, to, axis, limit, coordinates));
        }
    }
    kept.dedup();
    if let Some(&first) = kept.first()
        && kept.last() != Some(&first)
    {
        kept.push(first);
    }
    kept
}

/// Where an edge crosses a line, on the grid; the same for both directions of the edge.
fn crossing(a: Point, b: Point, axis: usize, limit: f64, coordinates: &Coordinates) -> Point {
    let [a, b] = if (b[0], b[1]) < (a[0], a[1]) { [b, a] } else { [a, b] };
    let along = (limit - a[axis]) / (b[axis] - a[axis]);
    let mut place: Point = std::array::from_fn(|it| coordinates.rounded(a[it] + (b[it] - a[it]) * along));
    place[axis] = limit;
    place
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: Coordinates = Coordinates::I32 { scale: [1.0; 3], offset: [0.0; 3] };

    /// Twice the signed area.
    fn area(ring: &[Point]) -> f64 {
        ring.windows(2).map(|ends| ends[0][0] * ends[1][1] - ends[1][0] * ends[0][1]).sum()
    }

    #[test]
    fn the_inside_stays() {
        let bounds = Bounds { min: [0.0, 0.0, 0.0], max: [10.0, 10.0, 0.0] };
        let ring = [[-5.0, 2.0, 8.0], [5.0, 2.0, 8.0], [5.0, 4.0, 8.0], [-5.0, 4.0, 8.0], [-5.0, 2.0, 8.0]];
        let inside = cut(&ring, &bounds, &GRID);
        assert_eq!(area(&inside), 2.0 * 10.0);
        assert!(inside.iter().all(|place| place[2] == 8.0 && place[0] >= 0.0));
        assert_eq!(inside.first(), inside.last());
        let all = ring.map(|[x, y, z]| [x + 5.0, y, z]);
        assert_eq!(cut(&all, &bounds, &GRID), all);
        assert_eq!(cut(&ring.map(|[x, y, z]| [x - 6.0, y, z]), &bounds, &GRID), Vec::<Point>::new());
        // The box's corner is inside of the ring.
        let around =
            [[5.0, 5.0, 3.0], [20.0, 5.0, 3.0], [20.0, 20.0, 3.0], [5.0, 20.0, 3.0], [5.0, 5.0, 3.0]];
        assert_eq!(area(&cut(&around, &bounds, &GRID)), 2.0 * 25.0);
    }

    #[test]
    fn elevations_are_interpolated() {
        let bounds = Bounds { min: [0.0, 0.0, 0.0], max: [10.0, 10.0, 0.0] };
        let ring =
            [[5.0, 1.0, 10.0], [15.0, 1.0, 20.0], [15.0, 3.0, 20.0], [5.0, 3.0, 10.0], [5.0, 1.0, 10.0]];
        let inside = cut(&ring, &bounds, &GRID);
        assert!(inside.contains(&[10.0, 1.0, 15.0]) && inside.contains(&[10.0, 3.0, 15.0]), "{inside:?}");
    }
}

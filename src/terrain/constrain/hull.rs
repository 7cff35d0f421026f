//! A part of the convex hull of the mesh that is known before the mesh has ended.
//!
//! The border of the hull is not known until then, but what is well inside of the vertices so far stays
//! inside.

use spmesh_delaunay::cell_tree::CellBox;
use spmesh_stream::model::points::Point2;

/// Directions in which the outermost vertex is known.
const DIRECTIONS: usize = 16;

/// More than the roundings of distances, as a part of the extent.
const ROUNDINGS: f64 = 1e-12;

/// The polygon of the outermost vertices so far in some directions.
#[derive(Debug)]
pub(super) struct KnownHull {
    /// Directions, counterclockwise, with the outermost vertex and how far out it is.
    outermost: Vec<(Point2, Point2, f64)>,
    /// Sides, as a place, the unit vector to the inside, and the rounding of distances.
    sides: Vec<(Point2, Point2, f64)>,
    /// What must be between a place and the sides. In stored units.
    margin: f64,
}

fn dot(a: Point2, b: Point2) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn minus(a: Point2, b: Point2) -> Point2 {
    [a[0] - b[0], a[1] - b[1]]
}

impl KnownHull {
    pub(super) fn new(margin: f64) -> KnownHull {
        let angle = |number: usize| number as f64 * std::f64::consts::TAU / DIRECTIONS as f64;
        let direction = |number: usize| [angle(number).cos(), angle(number).sin()];
        let outermost = (0..DIRECTIONS).map(|it| (direction(it), [0.0; 2], f64::NEG_INFINITY)).collect();
        KnownHull { outermost, sides: Vec::new(), margin }
    }

    /// Takes note of vertices, which are in a box.
    pub(super) fn extend(&mut self, bounds: &CellBox, places: impl Iterator<Item = Point2>) {
        let corner =
            |way: Point2| [0, 1].map(|axis| [bounds.min, bounds.max][usize::from(way[axis] > 0.0)][axis]);
        if self.outermost.iter().all(|&(way, _, far)| dot(way, corner(way)) <= far) {
            return;
        }
        for place in places {
            for (way, outermost, far) in &mut self.outermost {
                let out = dot(*way, place);
                if out > *far {
                    (*outermost, *far) = (place, out);
                }
            }
        }
        let ends = self.outermost.iter().zip(self.outermost.iter().cycle().skip(1));
        let sides = ends.map(|(&(_, from, _), &(_, to, _))| (from, minus(to, from)));
        let slack = |place: Point2| ROUNDINGS * (place[0].abs() + place[1].abs());
        let side = |(from, along): (Point2, Point2)| {
            let length = along[0].hypot(along[1]);
            (from, [-along[1] / length, along[0] / length], slack(from) + ROUNDINGS * length)
        };
        self.sides.clear();
        self.sides.extend(sides.filter(|(_, along)| *along != [0.0; 2]).map(side));
    }

    /// Whether a disk with the margin around it is inside, and stays so.
    #[inline]
    pub(super) fn contains(&self, centre: Point2, radius: f64) -> bool {
        let is_in = |&(from, inwards, slack): &(Point2, Point2, f64)| {
            dot(inwards, minus(centre, from)) > radius + self.margin + slack
        };
        // Without an area, no place is to the left of all sides.
        !self.sides.is_empty() && self.sides.iter().all(is_in)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_well_inside_is_known() {
        let mut hull = KnownHull::new(1.0);
        let corners = [[0.0, 0.0], [100.0, 0.0], [100.0, 50.0], [0.0, 50.0]];
        assert!(!hull.contains([50.0, 25.0], 0.0));
        for (count, is_known) in [(1, false), (2, false), (4, true)] {
            let places = &corners[..count];
            hull.extend(&CellBox::of(places), places.iter().copied());
            assert_eq!(hull.contains([50.0, 25.0], 20.0), is_known);
        }
        assert!(hull.contains([50.0, 25.0], 23.9) && !hull.contains([50.0, 25.0], 24.1));
        assert!(!hull.contains([50.0, 60.0], 1.0) && !hull.contains([50.0, 25.0], f64::NAN));
    }
}

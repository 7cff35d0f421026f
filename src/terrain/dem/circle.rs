//! Circles around triangles, and the cells in them.

use super::facet::place;
use super::rasterizer::least_first;
use spmesh_delaunay::predicates::{FiniteFloatPredicates, Point2, Predicates2, Sign, area};
use spmesh_stream::model::bounds::Point;

/// The circle around a triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Circle {
    /// The corners of the triangle; the first one is least in x, then y.
    corners: [Point2; 3],
    /// The centre as seen from the first corner.
    way: Point2,
    /// How far the way is off at most, along each axis.
    doubt: f64,
    pub(super) centre: Point2,
    /// A little more than its radius.
    pub(super) radius: f64,
    /// The longest edge of the triangle.
    pub(super) longest: f64,
}

impl Circle {
    /// The circle around a counterclockwise triangle. Which corner comes first makes no difference.
    pub(super) fn around(corners: [Point; 3]) -> Circle {
        let corners = least_first(corners).map(place);
        let [a, b, c] = corners;
        let [u, v, w] = [[a, b], [a, c], [b, c]].map(|[from, to]| [to[0] - from[0], to[1] - from[1]]);
        let [of_u, of_v, of_w] = [u, v, w].map(|way| way[0] * way[0] + way[1] * way[1]);
        // Accurate also for flat triangles.
        let size = 4.0 * area(a, b, c);
        let way = [(v[1] * of_u - u[1] * of_v) / size, (u[0] * of_v - v[0] * of_u) / size];
        // Each product is off by six roundings, and the area by 1e-14 of itself.
        let products = (v[0].abs() + v[1].abs()) * of_u + (u[0].abs() + u[1].abs()) * of_v;
        let doubt = 1e-15 * products / size + 2e-14 * (way[0].abs() + way[1].abs());
        let radius = (way[0] * way[0] + way[1] * way[1]).sqrt() * (1.0 + 1e-12);
        let longest = of_u.max(of_v).max(of_w).sqrt();
        Circle { corners, way, doubt, centre: [a[0] + way[0], a[1] + way[1]], radius, longest }
    }

    /// Half of the width of the circle at an ordinate, and a little more.
    #[inline]
    pub(super) fn half(&self, y: f64) -> f64 {
        let away = self.centre[1] - y;
        ((self.radius - away) * (self.radius + away)).max(0.0).sqrt() + 1e-12 * self.radius
    }

    /// Whether a place is inside, exactly: where weights are as small as errors, as at points, a wrong answer
    /// would be a value of errors alone.
    #[inline]
    pub(super) fn has(&self, place: Point2, predicates: &mut FiniteFloatPredicates) -> bool {
        let [x, y] = [place[0] - self.corners[0][0], place[1] - self.corners[0][1]];
        let (square, along) = (x * x + y * y, 2.0 * (x * self.way[0] + y * self.way[1]));
        let size = square + 2.0 * ((x * self.way[0]).abs() + (y * self.way[1]).abs());
        let bound = 2e-15 * size + 3.0 * (x.abs() + y.abs()) * self.doubt;
        let difference = along - square;
        // NaN is no certain sign.
        if difference.abs() > bound {
            return difference > 0.0;
        }
        let [a, b, c] = self.corners;
        predicates.incircle(a, b, c, place) == Sign::Positive
    }

    /// The centre as seen from a place.
    #[inline]
    pub(super) fn from(&self, place: Point2) -> Point2 {
        [0, 1].map(|axis| (self.corners[0][axis] - place[axis]) + self.way[axis])
    }
}

/// The centre of the circle around the origin and two places.
#[inline]
pub(super) fn centre(a: Point2, b: Point2) -> Point2 {
    let [of_a, of_b] = [a, b].map(|way| way[0] * way[0] + way[1] * way[1]);
    let size = 2.0 * (a[0] * b[1] - a[1] * b[0]);
    [(b[1] * of_a - a[1] * of_b) / size, (a[0] * of_b - b[0] * of_a) / size]
}

//! Circles around triangles, and the cells in them.

use spmesh_delaunay::predicates::{Point2, area};

/// The circle around a triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Circle {
    /// A corner of the triangle, the one that is least in x, then y.
    corner: Point2,
    /// The centre as seen from the corner.
    way: Point2,
    pub(super) centre: Point2,
    /// A little more than its radius.
    pub(super) radius: f64,
}

impl Circle {
    /// The circle around a counterclockwise triangle. Which corner comes first makes no difference.
    pub(super) fn around([a, b, c]: [Point2; 3]) -> Circle {
        let [a, b, c] = if a < b && a < c {
            [a, b, c]
        } else if b < c {
            [b, c, a]
        } else {
            [c, a, b]
        };
        let [u, v] = [b, c].map(|other| [other[0] - a[0], other[1] - a[1]]);
        let [of_u, of_v] = [u, v].map(|way| way[0] * way[0] + way[1] * way[1]);
        // Accurate also for flat triangles.
        let size = 4.0 * area(a, b, c);
        let way = [(v[1] * of_u - u[1] * of_v) / size, (u[0] * of_v - v[0] * of_u) / size];
        let radius = (way[0] * way[0] + way[1] * way[1]).sqrt() * (1.0 + 1e-12);
        Circle { corner: a, way, centre: [a[0] + way[0], a[1] + way[1]], radius }
    }

    /// Half of the width of the circle at an ordinate, and a little more.
    #[inline]
    pub(super) fn half(&self, y: f64) -> f64 {
        let away = self.centre[1] - y;
        ((self.radius - away) * (self.radius + away)).max(0.0).sqrt() + 1e-12 * self.radius
    }

    /// Whether a place is inside. Rounding decides where it is on the circle, the same way each time.
    #[inline]
    pub(super) fn has(&self, place: Point2) -> bool {
        let [x, y] = [place[0] - self.corner[0], place[1] - self.corner[1]];
        x * x + y * y < 2.0 * (x * self.way[0] + y * self.way[1])
    }

    /// The centre as seen from a place.
    #[inline]
    pub(super) fn from(&self, place: Point2) -> Point2 {
        [0, 1].map(|axis| (self.corner[axis] - place[axis]) + self.way[axis])
    }
}

/// The centre of the circle around the origin and two places.
#[inline]
pub(super) fn centre(a: Point2, b: Point2) -> Point2 {
    let [of_a, of_b] = [a, b].map(|way| way[0] * way[0] + way[1] * way[1]);
    let size = 2.0 * (a[0] * b[1] - a[1] * b[0]);
    [(b[1] * of_a - a[1] * of_b) / size, (a[0] * of_b - b[0] * of_a) / size]
}

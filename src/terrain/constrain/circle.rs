//! The circle of a triangle, and boxes that are certainly outside of it.

use super::cells::CellBox;
use spmesh_stream::model::points::Point2;

/// A disk that is a little larger than that of a triangle. Unit: cells.
#[derive(Debug, Clone, Copy)]
pub(super) struct Circle {
    corners: [Point2; 3],
    /// Twice the area of the triangle.
    twice_area: f64,
    centre: Point2,
    radius: f64,
    /// Whether rounding errors of centre and radius are smaller than what was added to the radius.
    is_certain: bool,
}

impl Circle {
    /// The circle through the corners of a triangle, in stored coordinates and in units of cells; `scale` is
    /// the number of cells per unit.
    pub(super) fn of(stored: [Point2; 3], corners: [Point2; 3], scale: f64) -> Circle {
        let [a, b, c] = stored;
        let [u, v] = [b, c].map(|p| [(p[0] - a[0]) * scale, (p[1] - a[1]) * scale]);
        let twice_area = u[0] * v[1] - u[1] * v[0];
        let [uu, vv] = [u, v].map(|p| p[0] * p[0] + p[1] * p[1]);
        let x = 0.5 * (v[1] * uu - u[1] * vv) / twice_area;
        let y = 0.5 * (u[0] * vv - v[0] * uu) / twice_area;
        let square = x * x + y * y;
        let radius = square.sqrt();
        let ww = (u[0] - v[0]).powi(2) + (u[1] - v[1]).powi(2);
        // Differences of integers are exact; those of other numbers are off by a part of the numbers.
        let is_exact = u
            .iter()
            .chain(&v)
            .all(|x| x.abs() > 1e-9 * (corners[0][0].abs() + corners[0][1].abs()) || *x == 0.0);
        let is_certain = is_exact && square < 1e8 * uu.min(vv).min(ww);
        Circle {
            corners,
            twice_area,
            centre: [corners[0][0] + x, corners[0][1] + y],
            radius: radius * 1.000_001 + 1e-6,
            is_certain,
        }
    }

    /// A box around the disk, perhaps without sides.
    pub(super) fn bounds(&self) -> CellBox {
        if !self.is_certain {
            return CellBox { min: [0.0; 2], max: [f64::INFINITY; 2] };
        }
        CellBox { min: self.centre.map(|x| x - self.radius), max: self.centre.map(|x| x + self.radius) }
    }

    /// Whether a box may meet the disk.
    pub(super) fn may_meet(&self, bounds: &CellBox) -> bool {
        if !self.is_certain {
            return self.may_meet_flat(bounds);
        }
        let mut square = 0.0;
        for axis in 0..2 {
            let nearest = self.centre[axis].clamp(bounds.min[axis], bounds.max[axis]);
            square += (self.centre[axis] - nearest).powi(2);
        }
        square <= self.radius * self.radius
    }

    /// The same for circles whose centre is too far to be computed.
    ///
    /// The power of a point is the square of its distance from the centre less that of the radius. Along an
    /// axis it is a square and a linear function, so inside of a box with the sides w and h it is less than
    /// at the corners by at most (w² + h²) / 4. Times twice the area of the triangle, it is the determinant
    /// of the in-circle test.
    fn may_meet_flat(&self, bounds: &CellBox) -> bool {
        let [width, height] = [0, 1].map(|axis| bounds.max[axis] - bounds.min[axis]);
        let dip = self.twice_area.abs() * (width * width + height * height) / 4.0;
        let [low, high] = [bounds.min, bounds.max];
        let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
        !corners.iter().all(|&corner| {
            let [power, error] = self.power(corner);
            power - error > dip
        })
    }

    /// The power of a place times twice the area, and a bound of its error.
    fn power(&self, place: Point2) -> [f64; 2] {
        let [a, b, c] = self.corners.map(|corner| [corner[0] - place[0], corner[1] - place[1]]);
        let lift = |p: Point2| p[0] * p[0] + p[1] * p[1];
        let minors = [[b, c], [c, a], [a, b]].map(|[p, q]| [p[0] * q[1], p[1] * q[0]]);
        let lifts = [a, b, c].map(lift);
        let value: f64 = (0..3).map(|i| lifts[i] * (minors[i][0] - minors[i][1])).sum();
        let size: f64 = (0..3).map(|i| lifts[i] * (minors[i][0].abs() + minors[i][1].abs())).sum();
        [-value, 1e-11 * (size + 1.0)]
    }
}

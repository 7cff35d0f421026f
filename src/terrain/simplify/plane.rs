//! How far points are from the plane of a triangle, at most.

use spmesh_stream::model::bounds::Point;

/// Largest relative error of a rounding.
const ROUNDING: f64 = f64::EPSILON / 2.0;

/// From this relative error of the area on, nothing is known of the plane.
const AREA_ERROR_MAX: f64 = 0.25;

/// The plane through three corners.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    at: Point,
    gradient: [f64; 2],
    /// What rounding has done to the gradient, at most.
    gradient_error: [f64; 2],
}

impl Plane {
    /// The plane of a triangle.
    ///
    /// With u for [`ROUNDING`], a determinant of differences is off by at most 8 u times the magnitudes of
    /// its products, as in the filters of predicates. So the area has a relative error of at most
    /// `area_error`, and a quotient by it is off by at most (8 u m / |area| + |q| (area_error + u)) / (1 -
    /// area_error), which is less than twice the sum without the last u, since area_error is at least 8 u and
    /// at most a quarter.
    pub(super) fn of([a, b, c]: [Point; 3]) -> Plane {
        let [u, v] = [b, c].map(|corner| [0, 1, 2].map(|axis| corner[axis] - a[axis]));
        let determinant = |i: usize, j: usize| {
            let (left, right) = (u[i] * v[j], v[i] * u[j]);
            (left - right, 8.0 * ROUNDING * (left.abs() + right.abs()))
        };
        let (area, area_error) = determinant(0, 1);
        let area_error = area_error / area.abs();
        let mut plane = Plane { at: a, gradient: [0.0; 2], gradient_error: [f64::INFINITY; 2] };
        // Comparisons with NaN are false.
        if area_error <= AREA_ERROR_MAX && area.is_normal() {
            for (axis, (rise, error)) in [determinant(2, 1), determinant(0, 2)].into_iter().enumerate() {
                let slope = rise / area;
                plane.gradient[axis] = slope;
                plane.gradient_error[axis] = 2.0 * (error / area.abs() + slope.abs() * area_error);
            }
        }
        plane
    }

    /// A bound of the vertical distance of a point from the plane: it is never less than the distance, and
    /// equal to it where heights are differences of integers to a level plane. Infinite if nothing is known.
    ///
    /// The terms and two differences of them pass at most five roundings each; 8 covers those of the bound.
    #[inline]
    pub(super) fn distance(&self, point: &Point, is_integer: bool) -> f64 {
        let [dx, dy, dz] = [0, 1, 2].map(|axis| point[axis] - self.at[axis]);
        let (x, y) = (self.gradient[0] * dx, self.gradient[1] * dy);
        let rounded = if is_integer && x == 0.0 && y == 0.0 { 0.0 } else { dz.abs() + x.abs() + y.abs() };
        let error = |axis: usize, d: f64| if d == 0.0 { 0.0 } else { self.gradient_error[axis] * d.abs() };
        let distance = (dz - x - y).abs() + (error(0, dx) + error(1, dy) + 8.0 * ROUNDING * rounded);
        if distance.is_nan() { f64::INFINITY } else { distance }
    }
}

//! The plane of a triangle.

use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::{Point2, area};
use spmesh_stream::model::bounds::Point;

/// If the determinant of a triangle is at least this part of the sum of its two products, its gradient is
/// accurate to 2^-30 of its differences in elevation. Thinner triangles are interpolated by areas, which are
/// always accurate.
const BROAD: f64 = 1.0 / (1u64 << 20) as f64;

/// A triangle with stored coordinates and elevations of the world, or other values of its corners.
#[derive(Debug)]
pub(super) struct Facet {
    corners: [Point; 3],
    /// In stored coordinates; NaN if products of coordinates overflow.
    pub(super) gradient: Point2,
    is_broad: bool,
    lowest: f64,
    highest: f64,
}

/// The place of a corner.
pub(super) fn place([x, y, _]: Point) -> Point2 {
    [x, y]
}

impl Facet {
    /// The plane of a triangle.
    ///
    /// Domain: corners counterclockwise.
    pub(super) fn of(corners: [Point; 3]) -> Facet {
        let [a, b, c] = corners;
        let [u, v] = [b, c].map(|corner| [0, 1, 2].map(|axis| corner[axis] - a[axis]));
        let products = [u[0] * v[1], u[1] * v[0]];
        let determinant = Some(2.0 * area(place(a), place(b), place(c)));
        // NaN if products of coordinates overflow.
        let determinant = determinant.filter(|size| size.is_finite() && *size > 0.0).unwrap_or(f64::NAN);
        let gradient = [(u[2] * v[1] - u[1] * v[2]) / determinant, (u[0] * v[2] - u[2] * v[0]) / determinant];
        // The greatest difference from the elevation of the first corner, along each axis.
        let rise = [0, 1].map(|axis| gradient[axis] * u[axis].abs().max(v[axis].abs()));
        let is_broad = determinant >= BROAD * (products[0].abs() + products[1].abs())
            && rise.iter().all(|rise| rise.is_finite());
        Facet {
            corners,
            gradient,
            is_broad,
            lowest: a[2].min(b[2]).min(c[2]),
            highest: a[2].max(b[2]).max(c[2]),
        }
    }

    /// The elevations at places of one ordinate in the closed triangle, clamped to those of its corners.
    #[inline]
    pub(super) fn row(&self, y: f64, abscissae: impl Iterator<Item = f64>, row: &mut [f32]) -> Result<()> {
        if !self.is_broad {
            return self.row_by_areas(y, abscissae, row);
        }
        let [a, ..] = self.corners;
        let start = a[2] + self.gradient[1] * (y - a[1]);
        for (value, x) in row.iter_mut().zip(abscissae) {
            let elevation = start + self.gradient[0] * (x - a[0]);
            *value = elevation.max(self.lowest).min(self.highest) as f32;
        }
        Ok(())
    }

    /// The values of the nearest corners with known values.
    pub(super) fn row_of_nearest(&self, y: f64, abscissae: impl Iterator<Item = f64>, row: &mut [f32]) {
        for (value, x) in row.iter_mut().zip(abscissae) {
            let known = self.corners.iter().filter(|corner| !corner[2].is_nan());
            let nearest = known.min_by(|p, q| {
                let distance = |corner: &Point| (corner[0] - x).hypot(corner[1] - y);
                distance(p).total_cmp(&distance(q))
            });
            *value = nearest.map_or(f32::NAN, |corner| corner[2] as f32);
        }
    }

    #[cold]
    fn row_by_areas(&self, y: f64, abscissae: impl Iterator<Item = f64>, row: &mut [f32]) -> Result<()> {
        for (value, x) in row.iter_mut().zip(abscissae) {
            let elevation = self.by_areas([x, y]);
            if elevation.is_nan() {
                return Err(out_of_range());
            }
            *value = elevation.clamp(self.lowest, self.highest) as f32;
        }
        Ok(())
    }

    /// The elevation by the areas of the triangles between a place and the edges.
    fn by_areas(&self, at: Point2) -> f64 {
        let [a, b, c] = self.corners;
        let [p, q, r] = [a, b, c].map(place);
        let shares = [area(at, q, r), area(p, at, r), area(p, q, at)];
        let sum = shares[0] * a[2] + shares[1] * b[2] + shares[2] * c[2];
        sum / (shares[0] + shares[1] + shares[2])
    }
}

/// The error of coordinates that are too large or too small to interpolate.
pub(super) fn out_of_range() -> Error {
    Error::usage("coordinates are too great or too small to interpolate between: shift and scale them")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn elevation(facet: &Facet, [x, y]: Point2) -> Result<f32> {
        let mut row = [0.0];
        facet.row(y, [x].into_iter(), &mut row)?;
        Ok(row[0])
    }

    #[test]
    fn planes_are_found_again() {
        let plane = |x: f64, y: f64| [x, y, 100.0 + 0.25 * x - 0.5 * y];
        let facet = Facet::of([plane(0.0, 0.0), plane(8.0, 1.0), plane(3.0, 9.0)]);
        assert!((facet.gradient[0] - 0.25).abs() < 1e-15 && (facet.gradient[1] + 0.5).abs() < 1e-15);
        assert_eq!(elevation(&facet, [3.0, 4.0]).unwrap(), 98.75);
    }

    #[test]
    fn needles_are_interpolated_accurately() {
        // A third corner 2^-20 above the middle of a diagonal of a million steps.
        let (length, height) = (2f64.powi(20), 2f64.powi(-20));
        let (half, quarter) = (0.5 * length, 0.25 * length);
        let facet = Facet::of([[0.0, 0.0, 0.0], [length, length, 10.0], [half, half + height, 7.0]]);
        assert!(!facet.is_broad);
        assert_eq!(elevation(&facet, [quarter, quarter]).unwrap(), 2.5);
        assert_eq!(elevation(&facet, [quarter, quarter + 0.5 * height]).unwrap(), 3.5);
        assert_eq!(elevation(&facet, [half, half + height]).unwrap(), 7.0);
    }

    #[test]
    fn nearest_corners_with_values_count() {
        let facet = Facet::of([[0.0, 0.0, 1.0], [8.0, 0.0, 2.0], [0.0, 8.0, f64::NAN]]);
        let mut row = [0.0; 3];
        facet.row_of_nearest(1.0, [1.0, 4.0, 5.0].into_iter(), &mut row);
        assert_eq!(row, [1.0, 1.0, 2.0]);
        facet.row_of_nearest(7.0, [0.0].into_iter(), &mut row);
        assert_eq!(row[0], 1.0);
    }

    #[test]
    fn numbers_out_of_range_are_none() {
        let facet = Facet::of([[0.0, 0.0, 0.0], [1e300, 0.0, 10.0], [0.0, 1e300, 7.0]]);
        assert!(elevation(&facet, [1e299, 1e299]).is_err());
    }
}

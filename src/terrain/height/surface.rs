//! The elevation at a place of a triangle.

use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::{Point2, area};
use spmesh_stream::model::bounds::Point;

/// Rounding makes a determinant of two products wrong by less than this part of their sum.
const ROUNDING: f64 = 1.0 / (1u64 << 50) as f64;

/// Products of two differences up to this are integers up to 2^52, which are exact, and so is their
/// difference.
pub(super) const PLAIN_MAX: f64 = (1u64 << 26) as f64;

/// If a height in units is nearer than this to the middle between two integers, exact arithmetic rounds it.
/// Heights in f64 are off by at most 2^-17: a few roundings of numbers below 2^34.
const NEAR_TIE: f64 = 1.0 / (1u64 << 12) as f64;

/// A place is on the edge to which a corner has at most this share: roundings of coordinates must not decide.
const ON_EDGE: f64 = 1e-6;

/// The shares of the corners in a place of the closed triangle, not normalized; `None` if the place is outside.
#[inline]
pub(super) fn shares(corners: &[Point; 3], at: &Point) -> Option<[f64; 3]> {
    let [a, b, c] = corners;
    // In most cases the first or second sign excludes the triangle.
    if is_right_of(at, a, b) || is_right_of(at, b, c) || is_right_of(at, c, a) {
        return None;
    }
    let [a, b, c] = [a, b, c].map(place);
    let at = place(at);
    let shares = [area(at, b, c), area(a, at, c), area(a, b, at)];
    shares.iter().all(|share| *share >= 0.0).then_some(shares)
}

/// [`shares`] without roundings.
///
/// Domain: coordinates are integers, and no difference of two of them is greater than [`PLAIN_MAX`].
#[inline]
pub(super) fn plain_shares([a, b, c]: &[Point; 3], at: &Point) -> Option<[f64; 3]> {
    let shares = [left_of(at, b, c), left_of(at, c, a), left_of(at, a, b)];
    (shares[0] >= 0.0 && shares[1] >= 0.0 && shares[2] >= 0.0).then_some(shares)
}

/// Twice the area of a place and an edge, positive if it is to the left.
#[inline]
fn left_of(at: &Point, from: &Point, to: &Point) -> f64 {
    (to[0] - from[0]) * (at[1] - from[1]) - (to[1] - from[1]) * (at[0] - from[0])
}

/// Whether a place is certainly to the right of the line from `from` to `to`.
#[inline]
fn is_right_of(at: &Point, from: &Point, to: &Point) -> bool {
    let left = (to[0] - from[0]) * (at[1] - from[1]);
    let right = (to[1] - from[1]) * (at[0] - from[0]);
    left - right < -ROUNDING * (left.abs() + right.abs())
}

fn place(&[x, y, _]: &Point) -> Point2 {
    [x, y]
}

/// The height of `point` above a triangle, in which it has `shares`.
pub(super) fn height(corners: &[Point; 3], shares: [f64; 3], point: &Point) -> Result<f64> {
    let [a, b, c] = corners.map(|corner| corner[2]);
    let sum = shares[0] + shares[1] + shares[2];
    let rise = (shares[1] * (b - a) + shares[2] * (c - a)) / sum;
    let (lowest, highest) = (a.min(b).min(c), a.max(b).max(c));
    // Rounding may not lead beyond the corners.
    let elevation = (a + rise).clamp(lowest, highest);
    let height = if elevation == a + rise { point[2] - a - rise } else { point[2] - elevation };
    if height.is_finite() {
        return Ok(height);
    }
    Err(beyond_numbers())
}

/// How much z changes over a unit of x and y in the direction of the steepest ascent, at the place of a
/// triangle where its corners have `shares`; along an edge if the place is on it, and 0 at a corner, so that
/// triangles which share the place agree. At most what it would be if all of the triangle's relief were over
/// `run`: a sliver between two points that nearly coincide is no cliff.
pub(super) fn slope(corners: &[Point; 3], shares: [f64; 3], run: f64) -> f64 {
    let [a, b, c] = corners;
    let least = ON_EDGE * (shares[0] + shares[1] + shares[2]);
    let is_off = shares.map(|share| share > least);
    let between = |p: &Point, q: &Point| {
        let [dx, dy, dz] = [0, 1, 2].map(|axis| q[axis] - p[axis]);
        dz.abs() / dx.hypot(dy).max(run)
    };
    match is_off {
        [true, true, true] => {}
        [false, true, true] => return between(b, c),
        [true, false, true] => return between(a, c),
        [true, true, false] => return between(a, b),
        _ => return 0.0,
    }
    let z = [a, b, c].map(|corner| corner[2]);
    let relief = z[0].max(z[1]).max(z[2]) - z[0].min(z[1]).min(z[2]);
    // `f64::min` ignores NaN.
    steepness(corners).min(relief / run)
}

/// The tangent of the slope of a triangle that is not flat in x and y.
pub(super) fn steepness([a, b, c]: &[Point; 3]) -> f64 {
    let [u, v] = [b, c].map(|corner| [0, 1, 2].map(|axis| corner[axis] - a[axis]));
    let size = u[0] * v[1] - v[0] * u[1];
    let rise = [u[2] * v[1] - v[2] * u[1], u[0] * v[2] - v[0] * u[2]];
    rise[0].hypot(rise[1]) / size.abs()
}

/// The error of coordinates that numbers of 64 bits cannot interpolate between.
pub(super) fn beyond_numbers() -> Error {
    Error::usage("coordinates are too great or too small to interpolate between: shift and scale them")
}

/// A height in units of `steps` steps, rounded to the nearest integer, half away from zero: exactly, if all
/// coordinates are integers.
///
/// Domain: corners and x, y of the point are of 32 bits, its z of 53, and `steps` is at most 2^21.
pub(super) fn rounded(corners: &[Point; 3], point: &Point, height: f64, steps: f64) -> f64 {
    let units = height / steps;
    let part = units.abs().fract();
    if (part - 0.5).abs() > NEAR_TIE {
        return units.round();
    }
    rounded_exactly(corners, point, steps)
}

/// [`rounded`] in integers. It is not inlined: few points need it, and its conversions would be made for
/// every triangle.
#[cold]
#[inline(never)]
fn rounded_exactly(corners: &[Point; 3], point: &Point, steps: f64) -> f64 {
    let [a, b, c] = corners.map(|corner| corner.map(|value| value as i128));
    let p = point.map(|value| value as i128);
    let cross = |u: [i128; 3], v: [i128; 3]| (u[0] - a[0]) * (v[1] - a[1]) - (u[1] - a[1]) * (v[0] - a[0]);
    let size = cross(b, c);
    let numerator = (p[2] - a[2]) * size - (b[2] - a[2]) * cross(p, c) - (c[2] - a[2]) * cross(b, p);
    let denominator = size * steps as i128;
    let rounded = (2 * numerator.abs() + denominator) / (2 * denominator);
    (rounded * numerator.signum()) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [Point; 3] = [[0.0, 0.0, 10.0], [8.0, 0.0, 20.0], [0.0, 8.0, 30.0]];

    #[test]
    fn places_on_the_border_are_inside() {
        for inside in [[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [4.0, 4.0, 0.0], [1.0, 1.0, 0.0]] {
            assert!(shares(&CORNERS, &inside).is_some(), "{inside:?}");
        }
        for outside in [[-1.0, 0.0, 0.0], [4.0, 4.0 + 1e-15, 0.0], [9.0, 0.0, 0.0]] {
            assert!(shares(&CORNERS, &outside).is_none(), "{outside:?}");
        }
    }

    #[test]
    fn plain_shares_are_those_of_exact_areas() {
        let mut random = spmesh_base::random::Random::new(9);
        for size in [3, 1000, PLAIN_MAX as u64] {
            let mut place = || [random.below(size) as f64, random.below(size) as f64, 0.0];
            for _ in 0..1000 {
                let (triangle, at) = ([place(), place(), place()], place());
                let twice = shares(&triangle, &at).map(|shares| shares.map(|share| 2.0 * share));
                assert_eq!(plain_shares(&triangle, &at), twice, "{triangle:?} {at:?}");
            }
        }
    }

    #[test]
    fn slopes_are_those_of_planes() {
        let middle = [1.0; 3];
        assert_eq!(slope(&CORNERS, middle, 1.0), (1.25f64).hypot(2.5));
        assert_eq!(slope(&[[0.0, 0.0, 3.0], [1.0, 0.0, 3.0], [5.0, 7.0, 3.0]], middle, 1.0), 0.0);
        // Slivers.
        assert_eq!(slope(&CORNERS, middle, 16.0), 1.25);
        assert_eq!(slope(&[[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [2.0, 2.0, 3.0]], middle, 4.0), 0.75);
        // Edges and corners.
        assert_eq!(slope(&CORNERS, [1.0, 2.0, 0.0], 1.0), 1.25);
        assert_eq!(slope(&CORNERS, [2.0, 1e-9, 1.0], 1.0), 2.5);
        assert_eq!(slope(&CORNERS, [0.0, 0.0, 1.0], 1.0), 0.0);
    }

    #[test]
    fn heights_are_rounded_once() {
        // The surface at (1, 2) is at 10 + 10 / 8 + 20 / 4 = 16.25.
        let point = [1.0, 2.0, 20.0];
        let above = height(&CORNERS, shares(&CORNERS, &point).unwrap(), &point).unwrap();
        assert_eq!(above, 3.75);
        assert_eq!(rounded(&CORNERS, &point, above, 1.0), 4.0);
        // Ties go away from zero.
        let high = [2.0, 0.0, 20.0];
        assert_eq!(rounded(&CORNERS, &high, 7.5, 1.0), 8.0);
        let low = [2.0, 0.0, 5.0];
        assert_eq!(rounded(&CORNERS, &low, -7.5, 1.0), -8.0);
        assert_eq!(rounded(&CORNERS, &low, -7.5, 5.0), -2.0);
        // A wrong height next to a tie is corrected.
        assert_eq!(rounded(&CORNERS, &high, 7.499_999, 1.0), 8.0);
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        let huge = [[0.0, 0.0, 0.0], [1e300, 0.0, 1.0], [0.0, 1e300, 2.0]];
        let at = [1e299, 1e299, 0.0];
        assert!(shares(&huge, &at).is_none_or(|shares| height(&huge, shares, &at).is_err()));
    }
}

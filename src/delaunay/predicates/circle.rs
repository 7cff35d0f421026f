//! Conservative test whether a circumcircle lies in a box: true only if it certainly does.
//!
//! The error bounds of thesis 5.7, redone. The thesis takes single-precision input and coefficients about
//! the origin of the plane; here input is any f64, coefficients are taken about one vertex of the triangle,
//! which keeps them small, and integer input has bounds of its own.
//!
//! # Derivation
//!
//! Write `u = 2^-53`, hats for computed values, and take vertex `a` as origin. Every bound below is rounded
//! up generously in its constant, which absorbs all terms of order `u^2`, and each bound that is itself
//! computed in floating point is multiplied by [`SLACK`], which is far more than its few roundings.
//!
//! * *Differences* `b - a`, `c - a`: relative error at most `u` for f64 input, none for integers below 2^53.
//! * *Squared lengths* `p = |b-a|^2`, `q = |c-a|^2`: sums of two squares, nothing cancels. Each factor brings
//!   the error of a difference, product and sum one rounding each: relative error below `4.1 u`, for exact
//!   differences below `2.1 u`.
//! * *Doubled area* `d = bx cy - by cx`, with `n_d = |bx cy| + |by cx|`: two differences and one rounding per
//!   product, one rounding of the result, which is at most `n_d`: `|d - d^| <= 5 u n_d^`; for exact
//!   differences `3 u n_d^`.
//! * *Numerators* `m_x = cy p - by q`, `m_y = bx q - cx p`, with `n` the sum of the absolute products: per
//!   product one difference, one squared length, one rounding; one rounding of the result:
//!   `|m - m^| <= 8 u n^`; for exact differences `5 u n^`.
//! * *Centre* `o = m / 2d` relative to `a`. With `E_d < |d^|`,
//!   `|m/2d - m^/2d^| = |(m - m^) d^ - m^ (d - d^)| / 2 |d| |d^| <= (E_m + 2 |o^| E_d) / 2 (|d^| - E_d)`,
//!   and one rounding of the quotient adds `u |o^|`. If `|d^| <= 2 E_d` nothing is claimed.
//! * *Radius* `r = |o| <= |o^| + E_x + E_y`, and the computed `|o^|` is off by less than `4 u |o^|`.
//! * *Sides*: `a + o + r` is summed in floating point with three roundings, each below `u` times the sum of
//!   the magnitudes; `4 u` times that sum covers them.
//! * *Power*: that of a place `w` relative to `a`, times `d`, is `g = d |w|^2 - m w`. With the roundings of
//!   `d x x`, of `m x`, of their difference and of sums, its part along an axis errs by at most
//!   `(E_d + 6 u |d^|) x^2 + (E_m + 6 u |m^|) |x|`. Along an axis, `g` is `d x^2` and a linear function, so
//!   inside of a box with the sides `s` and `t` it is less than at the corners by at most
//!   `d (s^2 + t^2) / 4`.
//!
//! Underflow would break relative errors: where one of `n_d`, `n_x`, `n_y`, `p`, `q` is below 2^-900 nothing
//! is claimed, and above it an underflowing product errs by less than 2^-1074, which is below `u` times the
//! sum. Overflow makes an infinity or a NaN, for which every comparison below is false; where only `2 d`
//! overflows, the products in `m` have long done so.

const U: f64 = f64::EPSILON / 2.0;
const SLACK: f64 = 1.0 + 1e-6;
const UNDERFLOW_GUARD: f64 = f64::from_bits((1023 - 900) << 52);

/// How large the errors of doubled area and numerators are, in units of `u` times the sum of magnitudes.
#[derive(Debug, Clone, Copy)]
pub struct CircleBounds {
    area: f64,
    numerator: f64,
}

impl CircleBounds {
    /// Bounds for arbitrary finite f64 coordinates.
    pub const FLOAT: CircleBounds = CircleBounds { area: 5.0 * U, numerator: 8.0 * U };

    /// Bounds for integer coordinates below 2^52 in magnitude, whose differences are exact.
    pub const INTEGER: CircleBounds = CircleBounds { area: 3.0 * U, numerator: 5.0 * U };

    /// The circle through `a`, `b` and `c`; `None` if underflow may spoil its error bounds. Overflow makes
    /// these infinite or NaN.
    #[inline]
    pub fn circle(self, a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> Option<Circle> {
        let (bx, by) = (b[0] - a[0], b[1] - a[1]);
        let (cx, cy) = (c[0] - a[0], c[1] - a[1]);
        let (p, q) = (bx * bx + by * by, cx * cx + cy * cy);
        let (d, n_d) = difference_of_products(bx, cy, by, cx);
        let (m_x, n_x) = difference_of_products(cy, p, by, q);
        let (m_y, n_y) = difference_of_products(bx, q, cx, p);
        let smallest = n_d.min(n_x).min(n_y).min(p).min(q);
        let numerators = [(m_x, self.numerator * n_x), (m_y, self.numerator * n_y)];
        // False for NaN, too.
        (smallest >= UNDERFLOW_GUARD).then_some(Circle { area: (d, self.area * n_d), numerators })
    }

    /// Whether the closed disk bounded by the circle through `a`, `b` and `c` certainly lies in the open
    /// interior of `region`, so that no point outside of the half-open region lies in it or on it.
    ///
    /// May answer false for a disk that is inside; never true for one that is not. Sides at infinity hold
    /// everything back from nothing.
    ///
    /// Source: thesis 5.3.3 and 5.7; the module's text has the derivation.
    #[inline]
    pub fn disk_inside(self, a: [f64; 2], b: [f64; 2], c: [f64; 2], region: [[f64; 2]; 2]) -> bool {
        let Some(disk) = self.circle(a, b, c).and_then(|circle| circle.disk()) else { return false };
        // Written so that a NaN anywhere answers false.
        let inside = |axis: usize| {
            let (o, reach) = (disk.centre[axis], disk.radius + disk.errors[axis]);
            let rounding = 4.0 * U * (a[axis].abs() + o.abs() + reach) * SLACK;
            let centre = a[axis] + o;
            centre - reach - rounding > region[0][axis] && centre + reach + rounding < region[1][axis]
        };
        inside(0) && inside(1)
    }
}

/// The circle through three points, seen from the first one. Pairs are a number and a bound of its error.
#[derive(Debug, Clone, Copy)]
pub struct Circle {
    /// Doubled area of the triangle.
    area: (f64, f64),
    /// Numerators of the coordinates of the centre.
    numerators: [(f64, f64); 2],
}

/// A disk that contains that of a circle, wherever in the bounds of its errors the centre is.
#[derive(Debug, Clone, Copy)]
pub struct Disk {
    /// The centre, relative to the first point.
    pub centre: [f64; 2],
    /// Bounds of the errors of its coordinates.
    pub errors: [f64; 2],
    /// At least the radius of the circle.
    pub radius: f64,
}

impl Circle {
    /// The disk; `None` if the triangle is too flat for the centre to have bounds.
    #[inline]
    pub fn disk(&self) -> Option<Disk> {
        let (d, e_d) = self.area;
        let margin = d.abs() - e_d;
        // False for NaN, too.
        let is_far_from_zero = d.abs() > 2.0 * e_d;
        if !is_far_from_zero {
            return None;
        }
        let centre = self.numerators.map(|(m, _)| m / (2.0 * d));
        let error = |axis: usize| {
            let (o, (_, e_m)) = (centre[axis].abs(), self.numerators[axis]);
            ((e_m + 2.0 * o * e_d) / (2.0 * margin) + U * o) * SLACK
        };
        let errors = [error(0), error(1)];
        let [x, y] = centre;
        let radius = (x * x + y * y).sqrt() * (1.0 + 8.0 * U) + (errors[0] + errors[1]) * SLACK;
        Some(Disk { centre, errors, radius })
    }

    /// Whether a closed box, with corners relative to the first point, certainly has nothing in common with
    /// the closed disk. The three points are counterclockwise. This tells more than [`Disk`] for flat
    /// triangles.
    pub fn misses(&self, [low, high]: [[f64; 2]; 2]) -> bool {
        let (d, e_d) = self.area;
        let power = |axis: usize, x: f64| {
            let (m, e_m) = self.numerators[axis];
            let error = (e_d + 6.0 * U * d.abs()) * x * x + (e_m + 6.0 * U * m.abs()) * x.abs();
            d * x * x - m * x - error * SLACK
        };
        let [xs, ys] = [0, 1].map(|axis| [low[axis], high[axis]].map(|x| power(axis, x)));
        let square: f64 = (0..2).map(|axis| (high[axis] - low[axis]) * (high[axis] - low[axis])).sum();
        let least = (d + e_d) * square / 4.0 * SLACK + UNDERFLOW_GUARD;
        // Written so that a NaN anywhere answers false.
        xs.iter().all(|x| ys.iter().all(|y| x + y > least))
    }
}

/// `a b - c d` and the sum of the magnitudes of the two products.
#[inline]
fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> (f64, f64) {
    let (left, right) = (a * b, c * d);
    (left - right, left.abs() + right.abs())
}

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

    /// Whether the closed disk bounded by the circle through `a`, `b` and `c` certainly lies in the open
    /// interior of `region`, so that no point outside of the half-open region lies in it or on it.
    ///
    /// May answer false for a disk that is inside; never true for one that is not. Sides at infinity hold
    /// everything back from nothing.
    ///
    /// Source: thesis 5.3.3 and 5.7; the module's text has the derivation.
    #[inline]
    pub fn disk_inside(self, a: [f64; 2], b: [f64; 2], c: [f64; 2], region: [[f64; 2]; 2]) -> bool {
        let (bx, by) = (b[0] - a[0], b[1] - a[1]);
        let (cx, cy) = (c[0] - a[0], c[1] - a[1]);
        let (p, q) = (bx * bx + by * by, cx * cx + cy * cy);
        let (d, n_d) = difference_of_products(bx, cy, by, cx);
        let (m_x, n_x) = difference_of_products(cy, p, by, q);
        let (m_y, n_y) = difference_of_products(bx, q, cx, p);
        let e_d = self.area * n_d;
        let margin = d.abs() - e_d;
        let smallest = n_d.min(n_x).min(n_y).min(p).min(q);
        // Written so that a NaN anywhere answers false.
        if !(d.abs() > 2.0 * e_d && smallest >= UNDERFLOW_GUARD) {
            return false;
        }
        let (o_x, o_y) = (m_x / (2.0 * d), m_y / (2.0 * d));
        let error = |o: f64, n: f64| {
            let quotient = (self.numerator * n + 2.0 * o.abs() * e_d) / (2.0 * margin);
            (quotient + U * o.abs()) * SLACK
        };
        let (e_x, e_y) = (error(o_x, n_x), error(o_y, n_y));
        let radius = (o_x * o_x + o_y * o_y).sqrt() * (1.0 + 8.0 * U) + (e_x + e_y) * SLACK;
        let inside = |axis: usize, o: f64, e: f64| {
            let reach = radius + e;
            let rounding = 4.0 * U * (a[axis].abs() + o.abs() + reach) * SLACK;
            let centre = a[axis] + o;
            centre - reach - rounding > region[0][axis] && centre + reach + rounding < region[1][axis]
        };
        inside(0, o_x, e_x) && inside(1, o_y, e_y)
    }
}

/// `a b - c d` and the sum of the magnitudes of the two products.
#[inline]
fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> (f64, f64) {
    let (left, right) = (a * b, c * d);
    (left - right, left.abs() + right.abs())
}

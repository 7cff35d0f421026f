//! Conservative test whether a circumscribing ball lies in a box: true only if it certainly does.
//!
//! [`super::circle`] in space: the error bounds of thesis 5.7, which treats circles, carried over to spheres.
//! Input is any f64, or integers; coefficients are taken about one vertex of the tetrahedron, which keeps
//! them small.
//!
//! # Derivation
//!
//! Write `u = 2^-53`, hats for computed values, and take vertex `a` as origin, so that `b`, `c` and `d` stand
//! for differences. Every bound below is rounded up in its constant by one at least, which absorbs all terms
//! of order `u^2`, the rounding of the sums of magnitudes `n` among them; each bound that is itself computed
//! in floating point is multiplied by [`SLACK`], which is far more than its few roundings.
//!
//! * *Differences*: relative error at most `u` for f64 input, none for integers below 2^53.
//! * *Squared lengths* `p = |b|^2`, `q = |c|^2`, `r = |d|^2`: sums of three squares, nothing cancels. Each
//!   square has the errors of two factors and a rounding, two sums round: relative error `5 u`; for exact
//!   differences `3 u`.
//! * *Minors*, the components of `X = c x d`, `Y = d x b`, `Z = b x c`, with `n` the sum of the magnitudes of
//!   the two products: two differences and a rounding per product, one rounding of the result: `4 u n`; for
//!   exact differences `2 u n`.
//! * *Sixfold volume* `v = b . X`, with `n_v = |b_x| n_Xx + |b_y| n_Xy + |b_z| n_Xz`: per product the error
//!   of a difference, of a minor, and a rounding; two sums round: `1 + 4 + 1 + 2`, so `|v - v^| <= 9 u n_v^`;
//!   for exact differences `0 + 2 + 1 + 2`, so `6 u n_v^`.
//! * *Numerators* `m = p X + q Y + r Z`, per axis, with `n = p n_X + q n_Y + r n_Z`: per product a squared
//!   length, a minor, a rounding; two sums round: `5 + 4 + 1 + 2`, so `|m - m^| <= 13 u n^`; for exact
//!   differences `3 + 2 + 1 + 2`, so `9 u n^`.
//! * *Underflow*: only where the three squared lengths are between 2^-200 and 2^200 is anything claimed. Then
//!   nothing overflows, and a product that underflows errs by 2^-1075 at most: two of them in a minor, which
//!   is multiplied by 2^200 at most, and three more in sums and squares. [`UNDERFLOW`] covers all of it many
//!   times over.
//! * *Centre* `o = m / 2v` relative to `a`. With `E_v < |v^|`, `|m/2v - m^/2v^| <= (E_m + 2 |o^| E_v) / 2
//!   (|v^| - E_v)`, and the product with a rounded reciprocal adds `2 u |o^|`. If `|v^| <= 2 E_v` nothing is
//!   claimed.
//! * *Radius* `|o| <= |o^| + E_x + E_y + E_z`, and the computed `|o^|` is off by less than `4 u |o^|`. An
//!   underflow of its squares is far below the rest, as the radius is half a side at least.
//! * *Weights*: [`SphereBounds::power_ball_inside`] has the lifts `p = |b|^2 - (w_b - w_a)` and so on, with
//!   `n_p = |b|^2 + |w_b - w_a|` in place of `p` in the sums of magnitudes. The difference of weights errs by
//!   `u` of itself, and the sum of both is rounded: `6 u n_p`, for exact differences of coordinates `4 u
//!   n_p`. So the constants of the numerators are greater by one. The radius is the root of `|o|^2 + W -
//!   w_a`, which grows no faster than `|o|`; four more roundings below the root are less than `8 u` of it.
//! * *Place of the centre*: `a + o` is rounded once, below `u` times the sum of the magnitudes; `2 u` times
//!   that sum covers it.
//! * *Sides*: `a + o + r` is summed in floating point with three roundings, each below `u` times the sum of
//!   the magnitudes; `4 u` times that sum covers them.

use super::{Point3, exact_integers, forms};
use num_bigint::BigInt;

const U: f64 = f64::EPSILON / 2.0;
const SLACK: f64 = 1.0 + 1e-6;

/// Squared lengths for which the bounds hold.
const SQUARES: std::ops::Range<f64> = power(-200)..power(200);

/// More than all that underflow can do to a numerator or a volume.
const UNDERFLOW: f64 = power(-850);

const fn power(exponent: i64) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

/// How large the errors of sixfold volume and numerators are, in units of `u` times the sum of magnitudes.
#[derive(Debug, Clone, Copy)]
pub struct SphereBounds {
    volume: f64,
    numerator: f64,
}

impl SphereBounds {
    /// Bounds for arbitrary finite f64 coordinates.
    pub const FLOAT: SphereBounds = SphereBounds { volume: 9.0 * U, numerator: 13.0 * U };

    /// Bounds for integer coordinates below 2^52 in magnitude, whose differences are exact.
    pub const INTEGER: SphereBounds = SphereBounds { volume: 6.0 * U, numerator: 9.0 * U };

    /// Whether the closed ball bounded by the sphere through four points certainly lies in the open interior
    /// of `region`, so that no point outside of the half-open region lies in it or on it.
    ///
    /// May answer false for a ball that is inside; never true for one that is not. Sides at infinity hold
    /// everything back from nothing. Of points more than 2^100 or less than 2^-100 apart nothing is ever
    /// claimed.
    ///
    /// Source: thesis 5.4 and 5.7; the module's text has the derivation.
    #[inline]
    pub fn ball_inside(self, corners: [Point3; 4], region: [[f64; 3]; 2]) -> bool {
        let (vectors, lifts) = from_first(corners);
        self.is_inside(corners[0], vectors, lifts, 0.0, region)
    }

    /// The same for points with weights: whether the ball around the orthocentre, with a squared radius that
    /// is that of the orthosphere and `greatest`, certainly lies in the open interior of `region`. No point
    /// outside of the half-open region is in conflict with the tetrahedron then, or orthogonal to it, if no
    /// weight is above `greatest`.
    ///
    /// Never true if one of the four weights is above `greatest`.
    #[inline]
    pub fn power_ball_inside(
        self,
        [a, b, c, d]: [Point3; 4],
        weights: [f64; 4],
        greatest: f64,
        region: [[f64; 3]; 2],
    ) -> bool {
        let vectors = [b, c, d].map(|point| difference(point, a));
        let lifts = std::array::from_fn(|i| {
            let (square, heavier) = (square(vectors[i]), weights[i + 1] - weights[0]);
            (square - heavier, square + heavier.abs())
        });
        let bounds = SphereBounds { numerator: self.numerator + U, ..self };
        bounds.is_inside(a, vectors, lifts, greatest - weights[0], region)
    }

    /// The centre of the sphere through four points, and how far off it may be; `None` if it cannot be told.
    #[inline]
    pub fn centre(self, corners: [Point3; 4]) -> Option<Centre> {
        let (a, (vectors, lifts)) = (corners[0], from_first(corners));
        let (o, e) = self.offset(vectors, lifts)?;
        let error = std::array::from_fn(|axis| e[axis] + 2.0 * U * (a[axis].abs() + o[axis].abs()) * SLACK);
        let margin = (e[0] + e[1] + e[2]) * SLACK;
        let radius = square(o).sqrt();
        let radii = [radius * (1.0 - 8.0 * U) - margin, radius * (1.0 + 8.0 * U) + margin];
        Some(Centre { at: std::array::from_fn(|axis| a[axis] + o[axis]), error, radii })
    }

    /// The centre relative to `a` of a tetrahedron of `a` and three vectors, with the lift of each and the
    /// sum of the magnitudes that it is made of, and the errors along the axes. `None` if the bounds do not
    /// hold.
    #[inline(always)]
    fn offset(
        self,
        [b, c, d]: [Point3; 3],
        [(p, n_p), (q, n_q), (r, n_r)]: [(f64, f64); 3],
    ) -> Option<(Point3, Point3)> {
        let ((x, n_x), (y, n_y), (z, n_z)) = (cross(c, d), cross(d, b), cross(b, c));
        let volume = b[0] * x[0] + b[1] * x[1] + b[2] * x[2];
        let n_volume = b[0].abs() * n_x[0] + b[1].abs() * n_x[1] + b[2].abs() * n_x[2];
        let e_volume = self.volume * n_volume + UNDERFLOW;
        let is_sound = [n_p, n_q, n_r].iter().all(|square| SQUARES.contains(square));
        // Written so that a NaN anywhere gives nothing.
        if !(is_sound && volume.abs() > 2.0 * e_volume) {
            return None;
        }
        let per_volume = 1.0 / (2.0 * volume);
        let per_margin = 1.0 / (2.0 * (volume.abs() - e_volume));
        let (mut o, mut e) = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            let m = p * x[axis] + q * y[axis] + r * z[axis];
            let n = n_p * n_x[axis] + n_q * n_y[axis] + n_r * n_z[axis];
            o[axis] = m * per_volume;
            let e_m = self.numerator * n + UNDERFLOW;
            let quotient = (e_m + 2.0 * o[axis].abs() * e_volume) * per_margin;
            e[axis] = (quotient + 2.0 * U * o[axis].abs()) * SLACK;
        }
        Some((o, e))
    }

    /// The test for a tetrahedron of `a` and three vectors, with the lift of each and the sum of the
    /// magnitudes that it is made of. `excess` is added to the squared radius.
    #[inline(always)]
    fn is_inside(
        self,
        a: Point3,
        vectors: [Point3; 3],
        lifts: [(f64, f64); 3],
        excess: f64,
        region: [[f64; 3]; 2],
    ) -> bool {
        let Some((o, e)) = self.offset(vectors, lifts).filter(|_| excess < SQUARES.end) else { return false };
        let radius = (square(o) + excess).sqrt() * (1.0 + 8.0 * U) + (e[0] + e[1] + e[2]) * SLACK;
        (0..3).all(|axis| {
            let reach = radius + e[axis];
            let rounding = 4.0 * U * (a[axis].abs() + o[axis].abs() + reach) * SLACK;
            let centre = a[axis] + o[axis];
            centre - reach - rounding > region[0][axis] && centre + reach + rounding < region[1][axis]
        })
    }
}

/// The centre of the sphere through four points, as floating point tells it.
#[derive(Debug, Clone, Copy)]
pub struct Centre {
    /// About where it is.
    pub at: Point3,
    /// How far off it may be, along each axis.
    pub error: Point3,
    /// The least and the greatest that the radius may be.
    pub radii: [f64; 2],
}

/// Whether the centre of the sphere through the corners of a tetrahedron that is positively oriented lies in
/// a half-open `region`: on its lower sides, or inside. Exact for all finite coordinates.
///
/// A region's sides are not NaN.
pub fn centre_is_inside(bounds: SphereBounds, corners: [Point3; 4], region: [[f64; 3]; 2]) -> bool {
    let about = bounds.centre(corners);
    (0..3).all(|axis| {
        let is_from = |side: f64| match about {
            _ if side == f64::NEG_INFINITY => true,
            _ if side == f64::INFINITY => false,
            Some(Centre { at, error, .. }) if at[axis] - error[axis] > side => true,
            Some(Centre { at, error, .. }) if at[axis] + error[axis] < side => false,
            _ => centre_is_from(side, axis, corners),
        };
        is_from(region[0][axis]) && !is_from(region[1][axis])
    })
}

/// Whether the coordinate of the centre is `side` or more, by big integers: with the vectors from a and their
/// squares p, q, r as in the module's text, whether m is at least 2 v (side - a).
#[cold]
fn centre_is_from(side: f64, axis: usize, [a, b, c, d]: [Point3; 4]) -> bool {
    let mut place = a;
    place[axis] = side;
    let [a, b, c, d, place] = exact_integers::integers([a, b, c, d, place]);
    let from_a = |point: [BigInt; 3]| -> [BigInt; 3] {
        let mut axes = point.into_iter().zip(&a).map(|(coordinate, origin)| coordinate - origin);
        std::array::from_fn(|_| axes.next().expect("three axes"))
    };
    let [b, c, d, place] = [b, c, d, place].map(from_a);
    let (x, y, z) = (forms::cross(&c, &d), forms::cross(&d, &b), forms::cross(&b, &c));
    let volume = forms::dot(&b, &x);
    let numerator = forms::lift(&b) * &x[axis] + forms::lift(&c) * &y[axis] + forms::lift(&d) * &z[axis];
    numerator >= volume * 2 * &place[axis]
}

/// The vectors from the first corner of a tetrahedron without weights, with the lift of each and the sum of
/// the magnitudes that it is made of.
#[inline(always)]
fn from_first([a, b, c, d]: [Point3; 4]) -> ([Point3; 3], [(f64, f64); 3]) {
    let vectors = [b, c, d].map(|point| difference(point, a));
    let lifts = vectors.map(|vector| {
        let lift = square(vector);
        (lift, lift)
    });
    (vectors, lifts)
}

#[inline(always)]
fn difference(p: Point3, q: Point3) -> Point3 {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

#[inline(always)]
fn square([x, y, z]: Point3) -> f64 {
    x * x + y * y + z * z
}

/// `p x q`, and for each component the sum of the magnitudes of its two products.
#[inline(always)]
fn cross(p: Point3, q: Point3) -> (Point3, Point3) {
    let [(x, n_x), (y, n_y), (z, n_z)] = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| {
        let (left, right) = (p[i] * q[j], p[j] * q[i]);
        (left - right, left.abs() + right.abs())
    });
    ([x, y, z], [n_x, n_y, n_z])
}

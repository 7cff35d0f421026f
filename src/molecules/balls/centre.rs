//! Orthocentres of tetrahedra: the vertices of the power diagram.

use num_bigint::BigInt;
use num_traits::Signed;
use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::predicates::exact_integers::{integers_in, unit_with_weights, weight_in};
use spmesh_delaunay::predicates::forms;
use spmesh_delaunay::vector::{cross, difference, dot};

/// A determinant below this share of the product of the lengths of its rows has lost too many digits.
const THIN: f64 = 1e-7;

/// The point that has the same power distance from four balls, relative to the first, and its power distance.
/// `weights` are squares of radii.
///
/// Domain: the centres are not in a plane. Accurate to about nine digits of the distance from the first
/// centre, however thin the tetrahedron is.
pub(super) fn orthocentre(points: [Point3; 4], weights: [f64; 4]) -> (Point3, f64) {
    let [b, c, d] = [1, 2, 3].map(|i| difference(points[i], points[0]));
    let [over_b, over_c, over_d] =
        [(b, 1), (c, 2), (d, 3)].map(|(p, i)| dot(p, p) - (weights[i] - weights[0]));
    let (bc, cd, db) = (cross(b, c), cross(c, d), cross(d, b));
    let volume = dot(b, cd);
    let lengths = dot(b, b) * dot(c, c) * dot(d, d);
    let centre = if volume * volume > THIN * THIN * lengths {
        let half = 0.5 / volume;
        [0, 1, 2].map(|axis| (over_b * cd[axis] + over_c * db[axis] + over_d * bc[axis]) * half)
    } else {
        exactly(points, weights)
    };
    (centre, dot(centre, centre) - weights[0])
}

/// The same in arbitrary precision.
#[cold]
#[inline(never)]
fn exactly(points: [Point3; 4], weights: [f64; 4]) -> Point3 {
    let unit = unit_with_weights(&points, &weights);
    let [a, b, c, d] = points.map(|point| integers_in(point, unit));
    let weights = weights.map(|weight| weight_in(weight, unit));
    let from_a = |p: [BigInt; 3]| -> [BigInt; 3] { std::array::from_fn(|axis| &p[axis] - &a[axis]) };
    let (b, c, d) = (from_a(b), from_a(c), from_a(d));
    let lift = |p: &[BigInt; 3], i: usize| forms::lift(p) - (&weights[i] - &weights[0]);
    let (over_b, over_c, over_d) = (lift(&b, 1), lift(&c, 2), lift(&d, 3));
    let (bc, cd, db) = (forms::cross(&b, &c), forms::cross(&c, &d), forms::cross(&d, &b));
    let divisor = forms::dot(&b, &cd) * 2;
    let numerators: [BigInt; 3] =
        std::array::from_fn(|axis| &over_b * &cd[axis] + &over_c * &db[axis] + &over_d * &bc[axis]);
    numerators.map(|numerator| quotient(&numerator, &divisor) * 2f64.powi(unit))
}

/// The quotient of two integers, rounded; infinite if it is out of range or the divisor is zero.
fn quotient(dividend: &BigInt, divisor: &BigInt) -> f64 {
    if divisor == &BigInt::ZERO {
        return f64::INFINITY;
    }
    // 64 bits of the quotient.
    let shift = 64 - (dividend.bits() as i64 - divisor.bits() as i64);
    let digits = match usize::try_from(shift) {
        Ok(shift) => (dividend.abs() << shift) / divisor.abs(),
        Err(_) => dividend.abs() / (divisor.abs() << shift.unsigned_abs() as usize),
    };
    let magnitude = u128::try_from(digits).expect("about 64 bits") as f64;
    let value = magnitude * 2f64.powi((-shift).clamp(-1100, 1100) as i32);
    if dividend.is_negative() == divisor.is_negative() { value } else { -value }
}

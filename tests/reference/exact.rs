//! Determinants of lifted points in arbitrary precision, by cofactors, with the perturbation written out.

use num_bigint::{BigInt, Sign};

/// An exact point. All points of a set are scaled by the same power of two.
pub type ExactPoint = [BigInt; 2];

/// The points as integers: times the least power of two that makes all of them integers, so that small ones
/// stay small.
pub fn exact_points(points: &[[f64; 2]]) -> Vec<ExactPoint> {
    let integers: Vec<ExactPoint> = points.iter().map(|p| p.map(times_2_1074)).collect();
    let zeros = integers.iter().flatten().filter_map(BigInt::trailing_zeros).min().unwrap_or(0);
    integers.into_iter().map(|p| p.map(|value| value >> zeros)).collect()
}

/// A finite `f64` times 2^1074, which is an integer.
pub fn times_2_1074(value: f64) -> BigInt {
    let bits = value.abs().to_bits();
    let exponent = bits >> 52;
    let significand = BigInt::from(bits & 0xf_ffff_ffff_ffff);
    let integer = if exponent == 0 {
        significand
    } else {
        (significand + BigInt::from(1u64 << 52)) << (exponent as usize - 1)
    };
    if value < 0.0 { -integer } else { integer }
}

pub fn sign(value: &BigInt) -> i32 {
    match value.sign() {
        Sign::Minus => -1,
        Sign::NoSign => 0,
        Sign::Plus => 1,
    }
}

/// Determinant of rows (x, y, 1): twice the signed area.
fn area(p: &ExactPoint, q: &ExactPoint, r: &ExactPoint) -> BigInt {
    &p[0] * &q[1] + &q[0] * &r[1] + &r[0] * &p[1] - &p[1] * &q[0] - &q[1] * &r[0] - &r[1] * &p[0]
}

/// 1 if pqr is counterclockwise, 0 if collinear, -1 if clockwise.
pub fn orientation(p: &ExactPoint, q: &ExactPoint, r: &ExactPoint) -> i32 {
    sign(&area(p, q, r))
}

/// Coefficients of the four lifts in the determinant of rows (x, y, lift, 1), with the sign that makes the
/// determinant positive where the fourth point is inside the counterclockwise circle of the others.
fn cofactors(points: [&ExactPoint; 4]) -> [BigInt; 4] {
    let [a, b, c, d] = points;
    [area(b, c, d), -area(a, c, d), area(a, b, d), -area(a, b, c)]
}

/// Sign of the in-circle determinant, unperturbed.
pub fn incircle(points: [&ExactPoint; 4]) -> i32 {
    let lifts = points.map(|p| &p[0] * &p[0] + &p[1] * &p[1]);
    sign(&cofactors(points).iter().zip(&lifts).map(|(cofactor, lift)| cofactor * lift).sum())
}

/// Sign of the determinant whose lifts are lift + epsilon^(n - rank). The determinant is a polynomial in
/// infinitesimals of decreasing size; its sign is the sign of its first nonzero coefficient.
pub fn incircle_perturbed(points: [&ExactPoint; 4]) -> i32 {
    let unperturbed = incircle(points);
    if unperturbed != 0 {
        return unperturbed;
    }
    let cofactors = cofactors(points);
    let mut ranked = [0, 1, 2, 3];
    ranked.sort_by(|&i, &j| points[j].cmp(points[i]));
    ranked.iter().map(|&i| sign(&cofactors[i])).find(|&s| s != 0).unwrap_or(0)
}

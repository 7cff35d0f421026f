//! Determinants of lifted points in space in arbitrary precision, by cofactors, with the perturbation written
//! out.

use super::exact::{sign, times_2_1074};
use num_bigint::BigInt;

/// An exact point. All points of a set are scaled by the same power of two.
pub type ExactPoint = [BigInt; 3];

/// The points as integers: times 2^1074, which makes every finite `f64` an integer.
pub fn exact_points(points: &[[f64; 3]]) -> Vec<ExactPoint> {
    points.iter().map(|p| p.map(times_2_1074)).collect()
}

/// Determinant of a square matrix, along its first row.
fn determinant(rows: &[Vec<BigInt>]) -> BigInt {
    let Some((first, rest)) = rows.split_first() else {
        return BigInt::from(1);
    };
    let without = |column: usize| -> Vec<Vec<BigInt>> {
        rest.iter().map(|row| [&row[..column], &row[column + 1..]].concat()).collect()
    };
    (0..first.len())
        .filter(|&column| first[column] != BigInt::ZERO)
        .map(|column| {
            let term = &first[column] * determinant(&without(column));
            if column % 2 == 0 { term } else { -term }
        })
        .sum()
}

/// Determinant of rows (1, x, y, z): six times the signed volume.
fn volume(points: [&ExactPoint; 4]) -> BigInt {
    let row = |p: &ExactPoint| [vec![BigInt::from(1)], p.to_vec()].concat();
    determinant(&points.map(row))
}

/// 1 if det(q - p, r - p, s - p) is positive, 0 if the points are coplanar, -1 if it is negative.
pub fn orientation(points: [&ExactPoint; 4]) -> i32 {
    sign(&volume(points))
}

/// Coefficients of the five lifts in the determinant of rows (1, x, y, z, lift), with the sign that makes the
/// determinant positive where the fifth point is inside the sphere of the positively oriented others.
fn cofactors(points: [&ExactPoint; 5]) -> [BigInt; 5] {
    let [a, b, c, d, e] = points;
    [
        volume([b, c, d, e]) * -1,
        volume([a, c, d, e]),
        volume([a, b, d, e]) * -1,
        volume([a, b, c, e]),
        volume([a, b, c, d]) * -1,
    ]
}

/// Sign of the in-sphere determinant, unperturbed.
pub fn insphere(points: [&ExactPoint; 5]) -> i32 {
    let lifts = points.map(|p| p.iter().map(|x| x * x).sum::<BigInt>());
    sign(&cofactors(points).iter().zip(&lifts).map(|(cofactor, lift)| cofactor * lift).sum())
}

/// Sign of the determinant whose lifts are lift + epsilon^(n - rank). The determinant is a polynomial in
/// infinitesimals of decreasing size; its sign is the sign of its first nonzero coefficient.
pub fn insphere_perturbed(points: [&ExactPoint; 5]) -> i32 {
    let unperturbed = insphere(points);
    if unperturbed != 0 {
        return unperturbed;
    }
    let cofactors = cofactors(points);
    let mut ranked = [0, 1, 2, 3, 4];
    ranked.sort_by(|&i, &j| points[j].cmp(points[i]));
    ranked.iter().map(|&i| sign(&cofactors[i])).find(|&s| s != 0).unwrap_or(0)
}

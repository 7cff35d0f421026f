//! Finite `f64` as integers of arbitrary size: they are dyadic rationals, so one power of two makes integers
//! of all of them.

use num_bigint::BigInt;
use num_traits::ToPrimitive;

/// Significand and exponent: `value == significand * 2^exponent`.
///
/// Domain: a finite number.
#[inline]
pub fn decompose(value: f64) -> (i64, i32) {
    debug_assert!(value.is_finite());
    let bits = value.to_bits();
    let biased = (bits >> 52 & 0x7ff) as i32;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    let (significand, exponent) =
        if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
    (if value.is_sign_negative() { -significand } else { significand }, exponent)
}

/// The points in the greatest power of two that makes integers of the significands of all coordinates.
///
/// Domain: finite coordinates.
pub fn integers<const N: usize, const D: usize>(points: [[f64; D]; N]) -> [[BigInt; D]; N] {
    integers_and_unit(points).0
}

/// [`integers`], and the exponent of that power of two.
pub fn integers_and_unit<const N: usize, const D: usize>(points: [[f64; D]; N]) -> ([[BigInt; D]; N], i32) {
    let unit = unit_of(&points);
    (points.map(|point| integers_in(point, unit)), unit)
}

/// [`integers`] for any number of points.
pub fn integers_of<const D: usize>(points: &[[f64; D]]) -> Vec<[BigInt; D]> {
    let unit = unit_of(points);
    points.iter().map(|&point| integers_in(point, unit)).collect()
}

/// The least exponent of a coordinate that is not zero; 0 if all are.
pub fn unit_of<const D: usize>(points: &[[f64; D]]) -> i32 {
    let parts = points.iter().flatten().map(|&coordinate| decompose(coordinate));
    parts.filter(|part| part.0 != 0).map(|part| part.1).min().unwrap_or(0)
}

/// [`unit_of`] for points with weights, which are in the square of the unit.
pub fn unit_with_weights<const N: usize, const D: usize>(points: &[[f64; D]; N], weights: &[f64]) -> i32 {
    let least = weights.iter().map(|&weight| unit_of(&[[weight]])).min().unwrap_or(0);
    unit_of(points).min(least.div_euclid(2))
}

/// A weight in the square of the unit, whose exponent is at most that of [`unit_with_weights`].
pub fn weight_in(weight: f64, unit: i32) -> BigInt {
    let [integer] = integers_in([weight], 2 * unit);
    integer
}

/// The coordinates in the power of two with this exponent, which is at most that of any of them.
pub fn integers_in<const D: usize>(point: [f64; D], unit: i32) -> [BigInt; D] {
    point.map(decompose).map(|(significand, exponent)| match significand {
        0 => BigInt::ZERO,
        _ => BigInt::from(significand) << (exponent - unit) as usize,
    })
}

/// The quotient of two integers times two to the power of `exponent`, to one unit in the last place; infinite
/// if it overflows.
///
/// Domain: the denominator is not zero.
pub fn quotient(numerator: &BigInt, denominator: &BigInt, exponent: i32) -> f64 {
    let shift = 64 + denominator.bits() as i64 - numerator.bits() as i64;
    let shifted = if shift >= 0 {
        (numerator << shift as usize) / denominator
    } else {
        numerator / (denominator << shift.unsigned_abs() as usize)
    };
    let mut value = shifted.to_f64().expect("65 bits");
    // In steps, as the power itself may overflow where the result does not.
    let mut left = i64::from(exponent) - shift;
    while left != 0 && value != 0.0 && value.is_finite() {
        let step = left.clamp(-1000, 1000);
        value *= 2f64.powi(step as i32);
        left -= step;
    }
    value
}

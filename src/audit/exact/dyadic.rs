//! Coordinates as exact integers: all of them multiplied by a common power of two.

use num_bigint::BigInt;

/// The first points relative to the last, times a common power of two; `None` if a difference exceeds 2^61.
/// The last point itself becomes zero.
pub(super) fn small_differences<const N: usize, const D: usize>(
    points: [[f64; D]; N],
) -> Option<[[i64; D]; N]> {
    let integers = whole(&points).or_else(|| scaled(&points))?;
    let mut differences = [[0; D]; N];
    for (difference, point) in differences.iter_mut().zip(&integers) {
        for axis in 0..D {
            let value = point[axis] - integers[N - 1][axis];
            if value.abs() > 1 << 61 {
                return None;
            }
            difference[axis] = value as i64;
        }
    }
    Some(differences)
}

/// The points themselves; `None` unless all coordinates are integers below 2^62.
fn whole<const N: usize, const D: usize>(points: &[[f64; D]; N]) -> Option<[[i128; D]; N]> {
    let is_whole = |value: f64| value.abs() < (1i64 << 62) as f64 && value as i64 as f64 == value;
    let all = points.as_flattened().iter().all(|&value| is_whole(value));
    all.then(|| points.map(|point| point.map(|value| i128::from(value as i64))))
}

/// The points times a power of two; `None` unless they are then below 2^124.
fn scaled<const N: usize, const D: usize>(points: &[[f64; D]; N]) -> Option<[[i128; D]; N]> {
    let (dyadics, unit) = dyadics(points);
    let fits = |value: &Dyadic| value.mantissa == 0 || value.exponent - unit <= 70;
    dyadics.as_flattened().iter().all(fits).then(|| {
        dyadics.map(|point| {
            point.map(|value| match value.mantissa {
                0 => 0,
                mantissa => i128::from(mantissa) << (value.exponent - unit),
            })
        })
    })
}

/// The points times a common power of two.
pub(crate) fn integers<const N: usize, const D: usize>(points: [[f64; D]; N]) -> [[BigInt; D]; N] {
    let (dyadics, unit) = dyadics(&points);
    dyadics.map(|point| {
        point.map(|value| match value.mantissa {
            0 => BigInt::ZERO,
            mantissa => BigInt::from(mantissa) << (value.exponent - unit),
        })
    })
}

/// The points relative to `origin`.
pub(super) fn differences<const N: usize, const D: usize>(
    points: [[BigInt; D]; N],
    origin: &[BigInt; D],
) -> [[BigInt; D]; N] {
    points.map(|point| std::array::from_fn(|axis| &point[axis] - &origin[axis]))
}

/// A finite f64 as `mantissa * 2^exponent`, the mantissa odd or zero.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Dyadic {
    pub(crate) mantissa: i64,
    pub(crate) exponent: i32,
}

impl Dyadic {
    pub(crate) fn of(value: f64) -> Self {
        let bits = value.to_bits();
        let fraction = (bits & ((1 << 52) - 1)) as i64;
        let (magnitude, exponent) = match (bits >> 52 & 0x7ff) as i32 {
            0 => (fraction, -1074),
            biased => (fraction | 1 << 52, biased - 1075),
        };
        if magnitude == 0 {
            return Dyadic { mantissa: 0, exponent: 0 };
        }
        let zeros = magnitude.trailing_zeros();
        let odd = magnitude >> zeros;
        Dyadic { mantissa: if value < 0.0 { -odd } else { odd }, exponent: exponent + zeros as i32 }
    }
}

/// The coordinates taken apart, and their smallest exponent.
fn dyadics<const N: usize, const D: usize>(points: &[[f64; D]; N]) -> ([[Dyadic; D]; N], i32) {
    let dyadics = points.map(|point| point.map(Dyadic::of));
    let exponents = dyadics.as_flattened().iter().filter(|value| value.mantissa != 0);
    let unit = exponents.map(|value| value.exponent).min().unwrap_or(0);
    (dyadics, unit)
}

//! The orientation of any five points.

use super::determinant::{Magnitude, dot, normal};
use super::exact::{Exactness, orientation};
use spmesh_delaunay::predicates::Sign;
use spmesh_stream::model::cells4::Point4;

/// A product of four differences is rounded at most 14 times; its magnitude is part of the bound.
const ERROR: f64 = 32.0 * f64::EPSILON;

/// Differences below this have products of four, and rounding errors of subnormal products, in range.
const DIFFERENCE_MAX: f64 = 1e60;
const UNDERFLOW: f64 = 1e-200;

/// Integers below this have determinants in 128 bits: 24 products of four differences, each below 2^27.
const INTEGER_MAX: f64 = 67_108_864.0;

/// The sign of det(b - a, c - a, d - a, e - a), exact for all finite coordinates.
///
/// Cost: about ten nanoseconds where the rounded value is conclusive; a few times that for integers below
/// 2^26; otherwise microseconds.
pub fn orient4d([a, b, c, d, e]: [Point4; 5]) -> Sign {
    let from = |p: Point4| -> Point4 { std::array::from_fn(|axis| p[axis] - a[axis]) };
    let (rows, last) = ([from(b), from(c), from(d)], from(e));
    let magnitude = |row: Point4| row.map(|x| Magnitude(x.abs()));
    let value = dot(&normal(rows.each_ref()), &last);
    let Magnitude(bound) = dot(&normal(rows.map(magnitude).each_ref()), &magnitude(last));
    let is_in_range = rows.iter().chain([&last]).flatten().all(|x| x.abs() < DIFFERENCE_MAX);
    if is_in_range && value.abs() > ERROR * bound + UNDERFLOW {
        return Sign::of(value);
    }
    let is_small = |x: &f64| x.abs() < INTEGER_MAX && x.fract() == 0.0;
    let is_integer = [a, b, c, d, e].iter().flatten().all(is_small);
    let exactness = if is_integer { Exactness::Int128 } else { Exactness::Big };
    match orientation(exactness, [a, b, c, d], e) {
        std::cmp::Ordering::Less => Sign::Negative,
        std::cmp::Ordering::Equal => Sign::Zero,
        std::cmp::Ordering::Greater => Sign::Positive,
    }
}

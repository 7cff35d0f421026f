//! Weights of natural neighbours for any finite coordinates, in integers of arbitrary size.

use super::cavity::Cavity;
use crate::predicates::exact_integers::{integers_in, quotient, unit_of};
use crate::predicates::{Point2, numerators2};
use num_bigint::BigInt;

type Place = [BigInt; 2];

/// Digits of the greatest error of a weight.
const DIGITS: u64 = 56;

/// Writes the weights of the second ends of the edges of the border, off by at most 2^-52.
///
/// Domain: the target is inside of the hull and no vertex. Cost: many microseconds.
#[cold]
pub(super) fn write(points: &[Point2], cavity: &Cavity, target: Point2, weights: &mut Vec<(u32, f64)>) {
    let all = cavity.border.iter().map(|edge| points[edge.ends[1] as usize]).chain([target]);
    let unit = unit_of(&all.collect::<Vec<Point2>>());
    let [x, y] = integers_in(target, unit);
    let at = |v: u32| {
        let [v_x, v_y] = integers_in(points[v as usize], unit);
        [v_x - &x, v_y - &y]
    };
    let mut digits = DIGITS;
    // Centres are finite and the sum of areas is not zero, so that enough digits are reached.
    while !write_rounded(at, cavity, digits, weights) {
        digits *= 2;
    }
}

/// Writes the weights, with centres of so many binary digits after the point. Returns whether these are
/// enough.
fn write_rounded(
    at: impl Fn(u32) -> Place,
    cavity: &Cavity,
    digits: u64,
    weights: &mut Vec<(u32, f64)>,
) -> bool {
    let target = || [BigInt::ZERO, BigInt::ZERO];
    let old: Vec<Place> =
        cavity.triangles.iter().map(|&[a, b, c]| centre([at(a), at(b), at(c)], digits)).collect();
    let new: Vec<Place> = cavity
        .border
        .iter()
        .map(|edge| centre([target(), at(edge.ends[0]), at(edge.ends[1])], digits))
        .collect();
    let mut areas = Vec::new();
    let mut error = BigInt::ZERO;
    for (place, edge) in cavity.border.iter().enumerate() {
        let fan = cavity.fan(edge).iter().map(|&triangle| &old[triangle as usize]);
        areas.push(area(&new[place], fan.chain([&new[cavity.next(place)]]), &mut error));
    }
    let total: BigInt = areas.iter().sum();
    if (error << (DIGITS as usize + 1)) > total {
        return false;
    }
    weights.clear();
    let pairs = cavity.border.iter().zip(&areas);
    weights.extend(pairs.map(|(edge, area)| (edge.ends[1], quotient(area, &total, 0).max(0.0))));
    true
}

/// The centre of a circle, each coordinate off by less than one in the last digit.
fn centre([a, b, c]: [Place; 3], digits: u64) -> Place {
    let sides = [b, c].map(|p| [&p[0] - &a[0], &p[1] - &a[1]]);
    let (numerators, determinant) = numerators2(&sides);
    let doubled = determinant * 2;
    let [x, y] = numerators.map(|numerator| (numerator << digits as usize) / &doubled);
    let [a_x, a_y] = a;
    [(a_x << digits as usize) + x, (a_y << digits as usize) + y]
}

/// The doubled area of a clockwise polygon. Adds a bound of its error: coordinates of sides are off by less
/// than two, so that a product of x and y, of which each triangle has two, is off by 2 (|x| + |y|) + 4.
fn area<'p>(first: &Place, others: impl Iterator<Item = &'p Place>, error: &mut BigInt) -> BigInt {
    let mut doubled = BigInt::ZERO;
    let mut last = [BigInt::ZERO, BigInt::ZERO];
    for other in others {
        let side = [&other[0] - &first[0], &other[1] - &first[1]];
        doubled += &last[1] * &side[0] - &last[0] * &side[1];
        let lengths = last.iter().chain(&side).map(BigInt::magnitude);
        *error += BigInt::from(lengths.sum::<num_bigint::BigUint>() * 2u32 + 8u32);
        last = side;
    }
    doubled
}

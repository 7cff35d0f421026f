//! Sibson's coordinates by definition: the areas of intersections of half-planes, in exact rationals. Cost:
//! O(n^4).

use crate::exact::{ExactPoint, exact_points, sign};
use num_bigint::BigInt;

/// A x + B y <= C.
type HalfPlane = [BigInt; 3];

/// A point by homogeneous coordinates, of which the last is positive.
type Homogeneous = [BigInt; 3];

/// A numerator and a positive denominator.
#[derive(Debug, Clone)]
pub struct Rational(BigInt, BigInt);

impl Rational {
    fn plus(self, other: Rational) -> Rational {
        Rational(self.0 * &other.1 + other.0 * &self.1, self.1 * other.1)
    }

    /// The nearest `f64`, up to one unit in the last place, of a number that is zero or has a magnitude from
    /// 2^-900 to 1.
    pub fn to_float(&self) -> f64 {
        let digits = 1000;
        let shifted: BigInt = (&self.0 << digits as usize) / &self.1;
        let excess = shifted.bits().saturating_sub(100);
        let leading = i128::try_from(shifted >> excess).expect("100 bits");
        leading as f64 * 2f64.powi(excess as i32 - digits)
    }
}

/// For each point its natural-neighbour weight at the target.
///
/// Domain: distinct points; the target is none of them, and strictly inside of their convex hull.
pub fn sibson(points: &[[f64; 2]], target: [f64; 2]) -> Vec<Rational> {
    let mut exact = exact_points(&[points, &[target]].concat());
    let target = exact.pop().expect("the target");
    let cell: Vec<HalfPlane> = exact.iter().map(|point| nearer_to(&target, point)).collect();
    let stolen = exact.iter().map(|point| {
        let others = exact.iter().filter(|other| *other != point);
        let old = others.map(|other| nearer_to(point, other));
        doubled_area(&cell.iter().cloned().chain(old).collect::<Vec<_>>())
    });
    let areas: Vec<Rational> = stolen.collect();
    let total = areas.iter().cloned().reduce(Rational::plus).expect("points");
    assert_eq!(mean(&exact, &areas, &total), Some(target), "Sibson's identity");
    areas.into_iter().map(|Rational(n, d)| Rational(n * &total.1, d * &total.0)).collect()
}

/// The mean of points in these weights, if it is an integer.
fn mean(points: &[ExactPoint], weights: &[Rational], total: &Rational) -> Option<ExactPoint> {
    let coordinate = |axis: usize| {
        let terms = points.iter().zip(weights).map(|(p, Rational(n, d))| Rational(&p[axis] * n, d.clone()));
        let sum = terms.reduce(Rational::plus)?;
        let (numerator, denominator) = (sum.0 * &total.1, sum.1 * &total.0);
        let quotient = &numerator / &denominator;
        (&quotient * denominator == numerator).then_some(quotient)
    };
    Some([coordinate(0)?, coordinate(1)?])
}

fn nearer_to(p: &ExactPoint, q: &ExactPoint) -> HalfPlane {
    let square = |p: &ExactPoint| &p[0] * &p[0] + &p[1] * &p[1];
    [(&q[0] - &p[0]) * 2, (&q[1] - &p[1]) * 2, square(q) - square(p)]
}

fn meeting([a, b, c]: &HalfPlane, [d, e, f]: &HalfPlane) -> Option<Homogeneous> {
    let w = a * e - b * d;
    let (x, y) = (c * e - b * f, a * f - c * d);
    match sign(&w) {
        0 => None,
        1 => Some([x, y, w]),
        _ => Some([-x, -y, -w]),
    }
}

/// How far beyond the border of a half-plane a point is, times a positive number.
fn excess([a, b, c]: &HalfPlane, [x, y, w]: &Homogeneous) -> BigInt {
    a * x + b * y - c * w
}

/// Whether two half-planes are the same.
fn is_same(p: &HalfPlane, q: &HalfPlane) -> bool {
    meeting(p, q).is_none()
        && sign(&(&p[0] * &q[0] + &p[1] * &q[1])) > 0
        && [0, 1].iter().all(|&i| &p[i] * &q[2] == &q[i] * &p[2])
}

/// Twice the area of a bounded intersection of half-planes: for each border the part of it, from one end to
/// the other with the inside to the left, makes a triangle with the origin.
fn doubled_area(planes: &[HalfPlane]) -> Rational {
    let mut area = Rational(BigInt::from(0), BigInt::from(1));
    for (place, plane) in planes.iter().enumerate() {
        if planes[..place].iter().any(|other| is_same(plane, other)) {
            continue;
        }
        let corners = planes.iter().filter_map(|other| meeting(plane, other));
        let corners = corners.filter(|corner| planes.iter().all(|other| sign(&excess(other, corner)) <= 0));
        let mut ends: Option<[Homogeneous; 2]> = None;
        for corner in corners {
            let [first, last] = ends.get_or_insert_with(|| [corner.clone(), corner.clone()]);
            // Along the border, (-b, a).
            let along = |p: &Homogeneous| &plane[0] * &p[1] - &plane[1] * &p[0];
            let is_before = |p: &Homogeneous, q: &Homogeneous| along(p) * &q[2] < along(q) * &p[2];
            if is_before(&corner, first) {
                *first = corner;
            } else if is_before(last, &corner) {
                *last = corner;
            }
        }
        if let Some([p, q]) = ends {
            area = area.plus(Rational(&p[0] * &q[1] - &p[1] * &q[0], &p[2] * &q[2]));
        }
    }
    area
}

//! The least orthospheres of simplices: their powers, and who is in conflict with them.
//!
//! A point x has the power |x - p|² - w from a point p of weight w. All corners of a simplex have the same
//! power from the points of a flat that is orthogonal to it; the point where this flat meets the simplex's
//! own is the orthocentre. Without weights it is the centre of the least circumscribed sphere, and the power
//! is the square of its radius. Another point is in conflict if the orthocentre's power from it is less.
//!
//! In the formulas the first corner a is the origin, and the lift of a point p is P = p² - (w_p - w_a). The
//! orthocentre of 0, b, c, d is n / 2 D with n = B (c × d) + C (d × b) + E (b × c) and D = det(b, c, d). That
//! of 0, b, c is (β b + γ c) / 2 W with β = B c² - C bc, γ = C b² - B bc and W = (b × c)². That of 0, b is B
//! b / 2 b².

use crate::tess3::exact::{Number, Vector, cross, difference, dot, square};
use crate::tess3::spheres::{four_times, orthosphere, twice};

/// A weighted point in any arithmetic.
#[derive(Debug, Clone)]
pub(super) struct Site<T> {
    pub(super) at: Vector<T>,
    pub(super) weight: T,
}

/// A quotient; the denominator is positive.
#[derive(Debug, Clone)]
pub(super) struct Fraction<T> {
    pub(super) numerator: T,
    pub(super) denominator: T,
}

/// A site relative to another.
struct Relative<T> {
    to: Vector<T>,
    square: T,
    lift: T,
}

impl<T: Number> Site<T> {
    fn from(&self, origin: &Site<T>) -> Relative<T> {
        let to = difference(&self.at, &origin.at);
        let square = square(&to);
        let lift = square.clone() - (self.weight.clone() - origin.weight.clone());
        Relative { to, square, lift }
    }
}

/// The power of the orthocentre of two, three or four sites that are in no flat of less dimension.
pub(super) fn power<T: Number>(sites: &[Site<T>]) -> Fraction<T> {
    let (numerator, denominator) = match sites {
        [a, b] => of_edge(b.from(a)),
        [a, b, c] => of_triangle(b.from(a), c.from(a)),
        [a, b, c, d] => of_tetrahedron([b, c, d].map(|site| site.from(a))),
        _ => unreachable!("two, three or four sites"),
    };
    let weight = denominator.clone() * sites[0].weight.clone();
    Fraction { numerator: numerator - weight, denominator }
}

/// The square of the distance of the orthocentre from the origin.
fn of_edge<T: Number>(b: Relative<T>) -> (T, T) {
    (b.lift.clone() * b.lift, four_times(b.square))
}

/// As [`of_edge`]: B² c² - 2 BC bc + C² b² over 4 W.
fn of_triangle<T: Number>(b: Relative<T>, c: Relative<T>) -> (T, T) {
    let mixed = twice(b.lift.clone() * c.lift.clone() * dot(&b.to, &c.to));
    let numerator = b.lift.clone() * b.lift * c.square - mixed + c.lift.clone() * c.lift * b.square;
    (numerator, four_times(square(&cross(&b.to, &c.to))))
}

/// As [`of_edge`].
fn of_tetrahedron<T: Number>(others: [Relative<T>; 3]) -> (T, T) {
    let lifts = others.each_ref().map(|other| other.lift.clone());
    let (n, determinant) = orthosphere(&others.map(|other| other.to), &lifts);
    (square(&n), four_times(determinant.clone() * determinant))
}

/// Negative if `other` is in conflict with the least orthosphere of one, two or three sites, zero if it is
/// orthogonal to it.
pub(super) fn conflict<T: Number>(sites: &[Site<T>], other: &Site<T>) -> T {
    let d = other.from(&sites[0]);
    match sites {
        [_] => d.lift,
        [a, b] => {
            let b = b.from(a);
            b.square * d.lift - b.lift * dot(&b.to, &d.to)
        }
        [a, b, c] => {
            let (b, c) = (b.from(a), c.from(a));
            let mixed = dot(&b.to, &c.to);
            let beta = b.lift.clone() * c.square - c.lift.clone() * mixed.clone();
            let gamma = c.lift * b.square - b.lift * mixed;
            square(&cross(&b.to, &c.to)) * d.lift - beta * dot(&b.to, &d.to) - gamma * dot(&c.to, &d.to)
        }
        _ => unreachable!("one, two or three sites"),
    }
}

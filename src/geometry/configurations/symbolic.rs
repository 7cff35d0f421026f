//! Signs for symbolically displaced knots ([`super::knots`]): determinants as polynomials in e, in big
//! integers.

use super::knots::Knots;
use crate::predicates::{Sign, exact_integers};
use num_bigint::BigInt;

/// A polynomial in e, by its coefficients from the constant one on.
type Polynomial = Vec<BigInt>;

/// Orientation of three knots of P(e); zero if they are collinear for all e.
///
/// Cost: microseconds.
pub(super) fn orient(knots: &Knots, ids: [u32; 3]) -> Sign {
    let [a, b, c] = moved(knots, ids);
    first_sign(&cross(&minus_each(&a, &c), &minus_each(&b, &c)))
}

/// In-circle sign of four knots of P(e), the first three counterclockwise; zero if they are on one circle for
/// all e.
pub(super) fn in_circle(knots: &Knots, ids: [u32; 4]) -> Sign {
    let [a, b, c, d] = moved(knots, ids);
    let [a, b, c] = [a, b, c].map(|point| minus_each(&point, &d));
    let terms = [(&a, &b, &c), (&b, &c, &a), (&c, &a, &b)];
    let sum = terms.map(|(p, q, r)| times(&lift(p), &cross(q, r)));
    first_sign(&sum.into_iter().reduce(|sum, term| plus(&sum, &term)).unwrap_or_default())
}

/// Positions as linear polynomials in e. The unit of e may differ from call to call.
fn moved<const N: usize>(knots: &Knots, ids: [u32; N]) -> [[Polynomial; 2]; N] {
    let points = exact_integers::integers(ids.map(|id| knots.at(id)));
    std::array::from_fn(|i| {
        let rank = BigInt::from(knots.rank(ids[i]));
        let [x, y] = &points[i];
        [vec![x.clone(), rank.clone()], vec![y.clone(), &rank * &rank]]
    })
}

fn combine(p: &Polynomial, q: &Polynomial, with: impl Fn(&BigInt, &BigInt) -> BigInt) -> Polynomial {
    let zero = BigInt::ZERO;
    let terms = 0..p.len().max(q.len());
    terms.map(|i| with(p.get(i).unwrap_or(&zero), q.get(i).unwrap_or(&zero))).collect()
}

fn plus(p: &Polynomial, q: &Polynomial) -> Polynomial {
    combine(p, q, |p, q| p + q)
}

fn minus(p: &Polynomial, q: &Polynomial) -> Polynomial {
    combine(p, q, |p, q| p - q)
}

fn times(p: &Polynomial, q: &Polynomial) -> Polynomial {
    let mut product = vec![BigInt::ZERO; p.len() + q.len() - 1];
    for (i, p) in p.iter().enumerate() {
        for (j, q) in q.iter().enumerate() {
            product[i + j] += p * q;
        }
    }
    product
}

fn minus_each(p: &[Polynomial; 2], q: &[Polynomial; 2]) -> [Polynomial; 2] {
    [minus(&p[0], &q[0]), minus(&p[1], &q[1])]
}

fn cross(p: &[Polynomial; 2], q: &[Polynomial; 2]) -> Polynomial {
    minus(&times(&p[0], &q[1]), &times(&p[1], &q[0]))
}

fn lift(p: &[Polynomial; 2]) -> Polynomial {
    plus(&times(&p[0], &p[0]), &times(&p[1], &p[1]))
}

fn first_sign(polynomial: &Polynomial) -> Sign {
    polynomial.iter().map(|c| Sign::of(c.clone())).find(|&sign| sign != Sign::Zero).unwrap_or(Sign::Zero)
}

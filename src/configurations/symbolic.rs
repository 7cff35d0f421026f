//! Signs for symbolically displaced knots ([`super::knots`]): determinants as polynomials in e.

use super::knots::{Displacement, Knots};
use num_bigint::BigInt;
use num_traits::Zero;
use spmesh_delaunay::delaunay2::MAX_POINTS;
use spmesh_delaunay::predicates::forms::{Form, Incircle, Number, Orient2d, lift};
use spmesh_delaunay::predicates::residues::{Integers, Residue};
use spmesh_delaunay::predicates::{Point2, Sign, exact_integers};
use std::array::from_fn;
use std::ops::{Add, Mul, Sub};

/// Orientation of three knots of P(e); zero if they are collinear for all e.
///
/// Domain: three knots that are collinear at e = 0. Cost: a tenth of a microsecond.
pub(super) fn orient(knots: &Knots, [a, b, c]: [u32; 3]) -> Sign {
    sign::<Orient2d, 2, 3>(knots, c, [a, b])
}

/// In-circle sign of four knots of P(e), the first three counterclockwise; zero if they are on one circle for
/// all e.
///
/// Domain: four knots that are on one circle or line at e = 0, or coincide. Cost: a tenth of a microsecond.
pub(super) fn in_circle(knots: &Knots, [a, b, c, d]: [u32; 4]) -> Sign {
    // Nearly always the first derivative decides.
    match sign::<Incircle, 3, 2>(knots, d, [a, b, c]) {
        Sign::Zero => sign::<Incircle, 3, 5>(knots, d, [a, b, c]),
        sign => sign,
    }
}

/// [`orient`] of three knots at the same place, or the sign of such a determinant of more.
///
/// Knots of ranks i, j and k are on a parabola, where the determinant is (j - i) (k - i) (k - j).
pub(super) fn orient_copies<const N: usize>(knots: &Knots, ids: [u32; N]) -> Sign {
    if is_even(ids.map(|id| knots.rank(id))) { Sign::Positive } else { Sign::Negative }
}

/// [`in_circle`] of four knots of which three at least are at the same place; `None` for others.
///
/// Four copies: only the coefficient of e^4 is not zero: minus the product of all differences of ranks, as
/// above, times the sum of the ranks. Three copies: their circle shrinks to a point, so the other knot is
/// outside.
#[inline]
pub(super) fn in_circle_of_copies(knots: &Knots, [a, b, c, d]: [u32; 4]) -> Option<Sign> {
    let is_copy = |p: u32, q: u32| knots.at(p) == knots.at(q);
    let (copies, is_swapped) = match [is_copy(a, b), is_copy(b, c), is_copy(c, d)] {
        [true, true, true] => return Some(orient_copies(knots, [a, b, c, d]).opposite()),
        [true, true, false] => ([a, b, c], false),
        // A determinant changes its sign when two of its points change places.
        [false, true, true] => ([d, b, c], true),
        [true, false, false] if is_copy(b, d) => ([a, b, d], true),
        [false, false, true] if is_copy(a, c) => ([a, d, c], true),
        _ => return None,
    };
    let turn = orient_copies(knots, copies);
    Some(if is_swapped { turn } else { turn.opposite() })
}

/// Whether an even number of exchanges sorts distinct ranks.
fn is_even<const N: usize>(ranks: [u32; N]) -> bool {
    let later = |i: usize| ranks[i + 1..].iter().filter(|&&rank| rank < ranks[i]).count();
    (0..N).map(later).sum::<usize>() % 2 == 0
}

/// The sign of the first that is not zero among the first C coefficients of a form. Domain: the constant one
/// is zero.
fn sign<F: Form<N, 2>, const N: usize, const C: usize>(knots: &Knots, from: u32, to: [u32; N]) -> Sign {
    let displaced = Displaced {
        from: knots.at(from),
        to: to.map(|id| knots.at(id)),
        rank: i64::from(knots.rank(from)),
        ranks: to.map(|id| i64::from(knots.rank(id))),
        map: knots.displacement(),
    };
    let integers = Integers::of(displaced.from, displaced.to);
    match displaced.bits(integers.bits_of_lengths(), F::DEGREE) {
        ..128 => displaced.sign_in::<F, C, 2>(&integers),
        128..256 => displaced.sign_in::<F, C, 4>(&integers),
        256..384 => displaced.sign_in::<F, C, 6>(&integers),
        _ => displaced.big_sign::<F, C>(),
    }
}

// Squares of ranks fit.
const _: () = assert!(MAX_POINTS < 1 << 31);

/// Knots of P(e), one of which is the origin of the others.
struct Displaced<const N: usize> {
    from: Point2,
    to: [Point2; N],
    rank: i64,
    ranks: [i64; N],
    map: Displacement,
}

impl<const N: usize> Displaced<N> {
    /// Bits of the magnitude of a coefficient other than the constant one, at most, for a form of some
    /// degree: one factor is a displacement. `lengths`: bits of differences of coordinates.
    fn bits(&self, lengths: i32, degree: i32) -> i32 {
        let greatest = self.ranks.iter().fold(self.rank, |greatest, rank| greatest.max(*rank));
        let displacement = 2 * (64 - greatest.leading_zeros() as i32) + 1 + self.map.bits();
        // At most 12 products, each of which gives at most 6 to a coefficient: less than 2^7.
        (degree - 1) * lengths.max(displacement) + displacement + 7
    }

    /// The derivatives of differences of points: those of ranks, which are below [`MAX_POINTS`], and of their
    /// squares, in the default map.
    fn displacement(&self, i: usize) -> [i64; 2] {
        let [p, q] = [self.ranks[i], self.rank].map(|rank| self.map.of(rank));
        [p[0] - q[0], p[1] - q[1]]
    }

    fn sign_in<F: Form<N, 2>, const C: usize, const L: usize>(&self, integers: &Integers<N, 2>) -> Sign {
        let lengths = integers.lengths::<L>();
        let vectors = from_fn(|i| {
            let displacement = self.displacement(i);
            from_fn(|axis| Polynomial::line(lengths[i][axis], Residue::shifted(displacement[axis], 0)))
        });
        value::<F, _, N, C>(&vectors).sign_by(|coefficient: &Residue<L>| coefficient.sign())
    }

    #[cold]
    fn big_sign<F: Form<N, 2>, const C: usize>(&self) -> Sign {
        let mut points = self.to.to_vec();
        points.push(self.from);
        let integers = exact_integers::integers_of(&points);
        let vectors = from_fn(|i| {
            let displacement = self.displacement(i);
            from_fn(|axis| {
                Polynomial::line(&integers[i][axis] - &integers[N][axis], BigInt::from(displacement[axis]))
            })
        });
        value::<F, _, N, C>(&vectors).sign_by(|coefficient: &BigInt| Sign::of(coefficient.clone()))
    }
}

fn value<F: Form<N, 2>, T: Number + Zero, const N: usize, const C: usize>(
    vectors: &[[Polynomial<T, C>; 2]; N],
) -> Polynomial<T, C> {
    F::value(vectors, |i| lift(&vectors[i]))
}

/// A polynomial in e, by its coefficients from the constant one on.
#[derive(Debug, Clone)]
struct Polynomial<T, const C: usize>([T; C]);

impl<T: Number + Zero, const C: usize> Polynomial<T, C> {
    fn line(constant: T, slope: T) -> Self {
        let mut coefficients = from_fn(|_| T::zero());
        [coefficients[0], coefficients[1]] = [constant, slope];
        Polynomial(coefficients)
    }

    fn sign_by(&self, sign: impl Fn(&T) -> Sign) -> Sign {
        self.0.iter().map(sign).find(|&sign| sign != Sign::Zero).unwrap_or(Sign::Zero)
    }
}

impl<T: Number, const C: usize> Add for Polynomial<T, C> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Polynomial(from_fn(|i| self.0[i].clone() + other.0[i].clone()))
    }
}

impl<T: Number, const C: usize> Sub for Polynomial<T, C> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Polynomial(from_fn(|i| self.0[i].clone() - other.0[i].clone()))
    }
}

/// Without coefficients beyond the last one, which forms do not reach.
impl<T: Number + Zero, const C: usize> Mul for Polynomial<T, C> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let mut product: [T; C] = from_fn(|_| T::zero());
        for (i, p) in self.0.iter().enumerate().filter(|(_, p)| !p.is_zero()) {
            for (j, q) in other.0.iter().enumerate().take(C - i).filter(|(_, q)| !q.is_zero()) {
                product[i + j] = product[i + j].clone() + p.clone() * q.clone();
            }
        }
        Polynomial(product)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_base::random::Random;

    /// Knots on a circle and a line, many of them repeated.
    fn knots(random: &mut Random) -> Knots {
        let places = [[3.0, 4.0], [5.0, 0.0], [0.0, 5.0], [-4.0, 3.0], [0.1, 0.7], [1.0, 3.0], [2.0, 1.0]];
        Knots::new((0..60).map(|_| places[(random.bits() % 7) as usize]).collect()).expect("knots")
    }

    fn displaced<const N: usize>(knots: &Knots, from: u32, to: [u32; N]) -> Displaced<N> {
        Displaced {
            from: knots.at(from),
            to: to.map(|id| knots.at(id)),
            rank: i64::from(knots.rank(from)),
            ranks: to.map(|id| i64::from(knots.rank(id))),
            map: knots.displacement(),
        }
    }

    #[test]
    fn all_ways_find_the_sign_of_big_integers() {
        let mut random = Random::new(1);
        let mut threes = 0;
        for _ in 0..200 {
            let knots = knots(&mut random);
            for _ in 0..100 {
                let ids = [(); 4].map(|()| (random.bits() % 60) as u32);
                if (0..4).any(|i| ids[i + 1..].contains(&ids[i])) {
                    continue;
                }
                let [a, b, c, d] = ids;
                let turn = displaced(&knots, c, [a, b]).big_sign::<Orient2d, 3>();
                let side = displaced(&knots, d, [a, b, c]).big_sign::<Incircle, 5>();
                if knots.are_copies(&[a, b, c]) {
                    assert_eq!(orient_copies(&knots, [a, b, c]), turn);
                }
                let copies_of = |p: u32| ids.iter().filter(|&&q| knots.are_copies(&[p, q])).count();
                let has_three = copies_of(a) > 2 || copies_of(b) > 2;
                assert_eq!(in_circle_of_copies(&knots, ids), has_three.then_some(side), "{ids:?}");
                threes += usize::from(has_three);
                assert_eq!(orient(&knots, [a, b, c]), turn, "{ids:?}");
                assert_eq!(in_circle(&knots, ids), side, "{ids:?}");
            }
        }
        assert!(threes > 100, "{threes}");
    }
}

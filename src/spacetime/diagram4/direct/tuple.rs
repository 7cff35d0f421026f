//! Spheres, hyperplanes and lifted points as tuples of six integers (thesis 3.6.1).

use crate::diagram4::determinant::{Number, difference, dot, lift, normal, sphere};
use num_traits::Signed;

/// Integers that are wide enough.
pub(super) trait Integer: Number + num_integer::Integer + Signed {}

impl<T: Number + num_integer::Integer + Signed> Integer for T {}

/// The integers (n, m, s): the value of a point x is n . x + m |x|^2 + s, negative inside of a sphere, or
/// beyond a hyperplane of the hull, whose m is 0. They have no divisor in common.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tuple<T> {
    n: [T; 4],
    pub(super) m: T,
    s: T,
}

impl<T: Integer> Tuple<T> {
    /// The sphere through five points that span space.
    pub(super) fn sphere([o, a, b, c, d]: [&[T; 4]; 5]) -> Tuple<T> {
        let (n, m) = sphere([a, b, c, d].map(|p| difference(p.clone(), o)));
        let two = T::one() + T::one();
        let shifted = std::array::from_fn(|axis| n[axis].clone() - two.clone() * m.clone() * o[axis].clone());
        let s = m.clone() * lift(o) - dot(&n, o);
        let is_negative = m.is_negative();
        Tuple { n: shifted, m, s }.with_sign(is_negative).reduced()
    }

    /// The hyperplane through four points, with a fifth on the side that is not beyond.
    pub(super) fn hyperplane([o, a, b, c]: [&[T; 4]; 4], inside: &[T; 4]) -> Tuple<T> {
        let n = normal([a, b, c].map(|p| difference(p.clone(), o)).each_ref());
        let s = T::zero() - dot(&n, o);
        let tuple = Tuple { n, m: T::zero(), s };
        let is_negative = tuple.value(inside).is_negative();
        tuple.with_sign(is_negative).reduced()
    }

    /// The value of a point.
    pub(super) fn value(&self, point: &[T; 4]) -> T {
        dot(&self.n, point) + self.m.clone() * lift(point) + self.s.clone()
    }

    /// `a * self + b * other`: one of their pencil (eq. 3.1).
    pub(super) fn combined(&self, a: &T, other: &Tuple<T>, b: &T) -> Tuple<T> {
        let of = |x: &T, y: &T| a.clone() * x.clone() + b.clone() * y.clone();
        let n = std::array::from_fn(|axis| of(&self.n[axis], &other.n[axis]));
        Tuple { n, m: of(&self.m, &other.m), s: of(&self.s, &other.s) }.reduced()
    }

    fn with_sign(self, is_negative: bool) -> Tuple<T> {
        let turn = |x: T| if is_negative { T::zero() - x } else { x };
        Tuple { n: self.n.map(turn), m: turn(self.m), s: turn(self.s) }
    }

    /// Divided by the greatest common divisor.
    fn reduced(self) -> Tuple<T> {
        let divisor = self.n.iter().fold(self.m.gcd(&self.s), |divisor, x| divisor.gcd(x));
        let over = |x: T| if divisor.is_one() { x } else { x / divisor.clone() };
        Tuple { n: self.n.map(over), m: over(self.m), s: over(self.s) }
    }
}

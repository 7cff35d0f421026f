//! Signs of polynomials in coordinates that are never wrong: a formula is written once, and evaluated in
//! numbers that know how far off they may be; if that leaves the sign open, in integers of any length.

use std::ops::{Add, Mul, Sub};

use num_bigint::BigInt;

use super::radius::Radius;
use spmesh_geometry::predicates::exact_integers::integers_and_unit;
use spmesh_geometry::predicates::{Point3, Sign};

/// What a formula is evaluated in.
pub(super) trait Number: Clone + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {}

impl Number for Approximate {}
impl Number for BigInt {}

/// A vector of any numbers.
pub(super) type Vector<T> = [T; 3];

/// A polynomial in the coordinates of `N` points and a radius, of the same unit, which comes as the square of
/// its numerator and the square of its denominator. All terms have the same degree in the unit of length.
pub(super) trait Polynomial<const N: usize> {
    /// Its value.
    fn value<T: Number>(points: [Vector<T>; N], radius: &[T; 2]) -> T;
}

/// Sign of a polynomial.
pub(super) fn sign<P: Polynomial<N>, const N: usize>(points: [Point3; N], radius: &Radius) -> Sign {
    let value = P::value(points.map(|point| point.map(Approximate::exactly)), &radius.approximate_squares());
    if value.value.abs() > value.error {
        return Sign::of(value.value);
    }
    let (points, unit) = integers_and_unit(points);
    Sign::of(P::value(points, &radius.squares_in(unit)))
}

/// A rounded number, and a bound of its distance to the true one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Approximate {
    pub(super) value: f64,
    pub(super) error: f64,
}

/// Covers the roundings of a bound that sums up four terms.
const OF_BOUNDS: f64 = 1.0 + 8.0 * f64::EPSILON;

impl Approximate {
    /// A number that is what it is meant to be.
    pub(super) fn exactly(value: f64) -> Self {
        Approximate { value, error: 0.0 }
    }

    /// A result rounded by half a unit in the last place, or within the least numbers, of operands whose
    /// errors may add up to `error`.
    fn rounded(value: f64, error: f64) -> Self {
        Approximate { value, error: (error + value.abs() * f64::EPSILON + f64::MIN_POSITIVE) * OF_BOUNDS }
    }

    /// Whether all but about the last five of its digits can be relied upon.
    pub(super) fn is_accurate(self) -> bool {
        self.value.is_finite() && self.error <= self.value.abs() * 1e-11
    }
}

impl Add for Approximate {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Approximate::rounded(self.value + other.value, self.error + other.error)
    }
}

impl Sub for Approximate {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Approximate::rounded(self.value - other.value, self.error + other.error)
    }
}

impl Mul for Approximate {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let error = self.value.abs() * other.error + (other.value.abs() + other.error) * self.error;
        Approximate::rounded(self.value * other.value, error)
    }
}

/// The root of a quotient of integers that are not negative, accurate to a few units in the last place, and
/// twice the exponent of two that it is to be multiplied with.
pub(super) fn root_of_quotient(dividend: &BigInt, divisor: &BigInt) -> (f64, i32) {
    const DIGITS: i64 = 64;
    let surplus = dividend.bits() as i64 - divisor.bits() as i64 - DIGITS;
    let exponent = surplus - surplus.rem_euclid(2);
    let quotient = match usize::try_from(exponent) {
        Ok(shift) => dividend / (divisor << shift),
        Err(_) => (dividend << exponent.unsigned_abs() as usize) / divisor,
    };
    let quotient = u128::try_from(quotient).expect("about 64 bits") as f64;
    (quotient.sqrt(), exponent as i32)
}

pub(super) fn difference<T: Number>(p: &Vector<T>, q: &Vector<T>) -> Vector<T> {
    std::array::from_fn(|axis| p[axis].clone() - q[axis].clone())
}

pub(super) fn sum<T: Number>(p: &Vector<T>, q: &Vector<T>) -> Vector<T> {
    std::array::from_fn(|axis| p[axis].clone() + q[axis].clone())
}

pub(super) fn times<T: Number>(factor: &T, p: &Vector<T>) -> Vector<T> {
    p.clone().map(|value| factor.clone() * value)
}

pub(super) fn dot<T: Number>(p: &Vector<T>, q: &Vector<T>) -> T {
    let [x, y, z] = std::array::from_fn(|axis| p[axis].clone() * q[axis].clone());
    x + y + z
}

pub(super) fn cross<T: Number>(p: &Vector<T>, q: &Vector<T>) -> Vector<T> {
    let minor = |i: usize, j: usize| p[i].clone() * q[j].clone() - p[j].clone() * q[i].clone();
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

pub(super) fn square<T: Number>(p: &Vector<T>) -> T {
    dot(p, p)
}

//! Exact signs of polynomials in coordinates. A formula is written once and evaluated in f64 with an error
//! bound; if that leaves the sign open, in big integers.

use std::ops::{Add, Mul, Sub};

use num_bigint::BigInt;

use super::alpha::Radius;
use spmesh_delaunay::predicates::exact_integers::integers_and_unit;
use spmesh_delaunay::predicates::{Point3, Sign};

/// The arithmetic of a formula.
pub(super) trait Number: Clone + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {}

impl Number for Approximate {}
impl Number for BigInt {}

/// A vector in any arithmetic.
pub(super) type Vector<T> = [T; 3];

/// A polynomial in the coordinates of `N` points and a radius in the same unit. The radius is given as the
/// squares of its numerator and its denominator. All terms have the same degree in the unit of length.
pub(super) trait Polynomial<const N: usize> {
    fn value<T: Number>(points: [Vector<T>; N], radius: &[T; 2]) -> T;
}

pub(super) fn sign<P: Polynomial<N>, const N: usize>(points: [Point3; N], radius: &Radius) -> Sign {
    let value = P::value(points.map(|point| point.map(Approximate::exactly)), &radius.approximate_squares());
    if value.value.abs() > value.error {
        return Sign::of(value.value);
    }
    let (points, unit) = integers_and_unit(points);
    Sign::of(P::value(points, &radius.squares_in(unit)))
}

/// A rounded number with a bound on its error.
#[derive(Debug, Clone, Copy)]
pub(super) struct Approximate {
    pub(super) value: f64,
    pub(super) error: f64,
}

/// Covers the roundings of a bound that sums up four terms.
const OF_BOUNDS: f64 = 1.0 + 8.0 * f64::EPSILON;

impl Approximate {
    /// A number without error.
    pub(super) fn exactly(value: f64) -> Self {
        Approximate { value, error: 0.0 }
    }

    /// The rounded result of an operation to whose error the operands contribute at most `error`. Rounding
    /// itself errs by at most half a unit in the last place, or less than the least normal number.
    fn rounded(value: f64, error: f64) -> Self {
        Approximate { value, error: (error + value.abs() * f64::EPSILON + f64::MIN_POSITIVE) * OF_BOUNDS }
    }

    /// Whether all of its digits except about the last five are reliable.
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

/// The root of a quotient of nonnegative integers: the result (m, e) stands for m * 2^(e / 2), where e is
/// even and m is accurate to a few units in the last place.
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

//! Determinants of differences of points, generic in the arithmetic.

use std::ops::{Add, Mul, Sub};

/// Numbers of a ring: `f64`, pairs of them, residues, big integers.
pub trait Number: Clone + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {}

impl<T: Clone + Add<Output = T> + Sub<Output = T> + Mul<Output = T>> Number for T {}

/// The sum of the magnitudes of all products of a value: subtraction adds.
#[derive(Debug, Clone, Copy)]
pub struct Magnitude(pub f64);

impl Add for Magnitude {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Magnitude(self.0 + other.0)
    }
}

impl Sub for Magnitude {
    type Output = Self;

    // Magnitudes add up, whatever the sign.
    #[allow(clippy::suspicious_arithmetic_impl)]
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Magnitude(self.0 + other.0)
    }
}

impl Mul for Magnitude {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Magnitude(self.0 * other.0)
    }
}

/// A determinant of N rows, one for each vector: its D coordinates, and its lift if there are more rows than
/// coordinates. Up to the sign.
pub trait Form<const N: usize, const D: usize> {
    /// The rows have lifts.
    const IS_LIFTED: bool = N > D;

    /// Factors of each product of the value.
    const DEGREE: i32 = if N > D { D as i32 + 2 } else { D as i32 };

    /// The value. `lift` tells the lift of a vector, by its place.
    fn value<T: Number>(vectors: &[[T; D]; N], lift: impl Fn(usize) -> T) -> T;
}

/// det(a - c, b - c), from the differences to c.
pub struct Orient2d;

impl Form<2, 2> for Orient2d {
    #[inline(always)]
    fn value<T: Number>([a, b]: &[[T; 2]; 2], _: impl Fn(usize) -> T) -> T {
        minor(a, b, 0, 1)
    }
}

/// The in-circle determinant of a, b, c and d, from the differences to d.
pub struct Incircle;

impl Form<3, 2> for Incircle {
    #[inline(always)]
    fn value<T: Number>([a, b, c]: &[[T; 2]; 3], lift: impl Fn(usize) -> T) -> T {
        lift(0) * minor(b, c, 0, 1) + lift(1) * minor(c, a, 0, 1) + lift(2) * minor(a, b, 0, 1)
    }
}

/// det(b - a, c - a, d - a), from the differences to a.
pub struct Orient3d;

impl Form<3, 3> for Orient3d {
    #[inline(always)]
    fn value<T: Number>([b, c, d]: &[[T; 3]; 3], _: impl Fn(usize) -> T) -> T {
        dot(&cross(b, c), d)
    }
}

/// The in-sphere determinant of a, b, c, d and e, from the differences to e.
pub struct Insphere;

impl Form<4, 3> for Insphere {
    #[inline(always)]
    fn value<T: Number>([a, b, c, d]: &[[T; 3]; 4], lift: impl Fn(usize) -> T) -> T {
        let (ab, cd) = (cross(a, b), cross(c, d));
        let (first, second) = (dot(&cd, b) * lift(0), dot(&cd, a) * lift(1));
        let (third, fourth) = (dot(&ab, d) * lift(2), dot(&ab, c) * lift(3));
        (first - second) + (third - fourth)
    }
}

#[inline(always)]
pub fn times<T: Number>(a: &T, b: &T) -> T {
    a.clone() * b.clone()
}

/// The 2x2 determinant of columns `i` and `j` of two rows.
#[inline(always)]
pub fn minor<T: Number>(p: &[T], q: &[T], i: usize, j: usize) -> T {
    times(&p[i], &q[j]) - times(&p[j], &q[i])
}

#[inline(always)]
pub fn cross<T: Number>(p: &[T; 3], q: &[T; 3]) -> [T; 3] {
    [minor(p, q, 1, 2), minor(p, q, 2, 0), minor(p, q, 0, 1)]
}

#[inline(always)]
pub fn dot<T: Number, const D: usize>(p: &[T; D], q: &[T; D]) -> T {
    let rest = times(&p[0], &q[0]) + times(&p[1], &q[1]);
    (2..D).fold(rest, |sum, i| sum + times(&p[i], &q[i]))
}

/// Squared length.
#[inline(always)]
pub fn lift<T: Number, const D: usize>(v: &[T; D]) -> T {
    dot(v, v)
}

//! Signs in arbitrary precision, for every finite input. A call costs microseconds.

use super::Sign;
use super::exact_integers::integers_of;
use super::forms::{Form, lift};
use num_bigint::BigInt;

/// The sign of a form of the differences from one point to others.
pub(super) fn sign<F: Form<N, D>, const N: usize, const D: usize>(from: [f64; D], to: [[f64; D]; N]) -> Sign {
    let mut points = to.to_vec();
    points.push(from);
    let integers = integers_of(&points);
    let vectors =
        std::array::from_fn(|i| std::array::from_fn(|axis| &integers[i][axis] - &integers[N][axis]));
    Sign::of(F::value::<BigInt>(&vectors, |i| lift(&vectors[i])))
}

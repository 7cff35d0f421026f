//! The audit's own exact arithmetic: orientation, in-circle, in-sphere, and how the canonical triangulation
//! breaks ties.
//!
//! Three steps, each with its proof. A *filter* in f64 decides where its error bound allows. Otherwise the
//! coordinates are multiplied by a common power of two that makes them integers. If their differences have at
//! most 61 bits, the determinants are evaluated in integers of fixed width. All other cases go to big
//! integers.

pub(super) mod dyadic;
pub(super) mod plane;
pub(super) mod power;
pub(super) mod space;

use std::cmp::Ordering;

/// The sign of an expression, as its order to zero, and whether the filter left it to exact arithmetic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Decided {
    pub(super) sign: Ordering,
    pub(super) exactly: bool,
}

/// The result of the filter, or of exact arithmetic if the filter leaves it open.
fn decided(filtered: Option<Ordering>, exact: impl FnOnce() -> Ordering) -> Decided {
    match filtered {
        Some(sign) => Decided { sign, exactly: false },
        None => Decided { sign: exact(), exactly: true },
    }
}

/// Half a unit in the last place of 1: the largest relative error of one rounding.
const ROUNDING: f64 = f64::EPSILON / 2.0;

/// The sign of a determinant with an error of at most `error`; `None` if the error leaves it open, or is
/// infinite or NaN.
fn decide(determinant: f64, error: f64) -> Option<Ordering> {
    if determinant > error {
        Some(Ordering::Greater)
    } else if determinant < -error {
        Some(Ordering::Less)
    } else {
        None
    }
}

/// Numbers around zero from an interval of a length, the same on every machine (xorshift64).
#[cfg(test)]
fn random(mut state: u64) -> impl FnMut(f64) -> f64 {
    move |length| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        ((state >> 11) as f64 / (1u64 << 53) as f64 - 0.5) * length
    }
}

/// 2 to the power of `exponent`, of a normal number.
const fn power_of_two(exponent: i64) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

//! The three arithmetics of every test: f64 with error bounds, 128-bit integers, and big integers.

use std::cmp::Ordering;

use num_bigint::BigInt;

/// Numbers for determinants.
pub(super) trait Number: Clone {
    fn plus(&self, other: &Self) -> Self;
    fn minus(&self, other: &Self) -> Self;
    fn times(&self, other: &Self) -> Self;
    /// The sign as an ordering to zero, if this arithmetic can tell.
    fn sign(&self) -> Option<Ordering>;
}

/// Integers whose sign is always known.
macro_rules! exact {
    ($type:ty, $zero:expr) => {
        impl Number for $type {
            fn plus(&self, other: &Self) -> Self {
                self + other
            }

            fn minus(&self, other: &Self) -> Self {
                self - other
            }

            fn times(&self, other: &Self) -> Self {
                self * other
            }

            fn sign(&self) -> Option<Ordering> {
                Some(self.cmp(&$zero))
            }
        }
    };
}

// Valid without overflow, which each test must guarantee.
exact!(i128, 0);
exact!(BigInt, BigInt::ZERO);

/// A number with an error bound: the true value differs from `value` by at most `error`.
///
/// One rounding errs by at most 2^-53 times the rounded result, and a product that underflows by at most
/// 2^-1075 on top. The bounds are rounded themselves, in at most six operations, which [`GROWTH`] covers.
/// [`TINY`] is part of every error and covers all underflow. After an overflow, the error is infinite or NaN,
/// and the sign is unknown.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ball {
    value: f64,
    error: f64,
}

/// 2^-53.
const ROUNDING: f64 = f64::EPSILON / 2.0;

/// 1 + 2^-49: more than (1 + 2^-53)^6 (1 + 2^-70).
const GROWTH: f64 = 1.0 + 8.0 * f64::EPSILON;

/// 2^-1000.
const TINY: f64 = f64::from_bits(23 << 52);

impl Ball {
    /// `p - q`.
    pub(super) fn difference(p: f64, q: f64) -> Self {
        Ball::rounded(p - q, 0.0)
    }

    /// A value that was just rounded, whose operands bring an error of at most `error`.
    fn rounded(value: f64, error: f64) -> Self {
        Ball { value, error: (error + value.abs() * ROUNDING) * GROWTH + TINY }
    }
}

impl Number for Ball {
    fn plus(&self, other: &Self) -> Self {
        Ball::rounded(self.value + other.value, self.error + other.error)
    }

    fn minus(&self, other: &Self) -> Self {
        Ball::rounded(self.value - other.value, self.error + other.error)
    }

    fn times(&self, other: &Self) -> Self {
        let error =
            self.value.abs() * other.error + other.value.abs() * self.error + self.error * other.error;
        Ball::rounded(self.value * other.value, error)
    }

    fn sign(&self) -> Option<Ordering> {
        if self.value > self.error {
            Some(Ordering::Greater)
        } else if self.value < -self.error {
            Some(Ordering::Less)
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_are_what_they_are_called() {
        assert_eq!(ROUNDING, 2f64.powi(-53));
        assert_eq!(GROWTH, 1.0 + 2f64.powi(-49));
        assert_eq!(TINY, 2f64.powi(-1000));
    }

    /// Evaluates the same expression of random numbers of all sizes in integers: the ball holds the value,
    /// and is not much too large.
    #[test]
    fn balls_hold_the_true_value() {
        let mut state = 7_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state as i64) >> 11 >> (state >> 6 & 31)
        };
        let mut decided = 0;
        for _ in 0..20_000 {
            let [a, b, c, d, e] = [(); 5].map(|()| random());
            let near = b.wrapping_add(random() >> 45);
            let ball = |p: i64, q: i64| Ball::difference(p as f64, q as f64);
            let big = |p: i64, q: i64| BigInt::from(p) - q;
            let found = ball(a, b)
                .times(&ball(c, d))
                .minus(&ball(a, near).times(&ball(c, d)))
                .times(&ball(e, a))
                .plus(&ball(a, c));
            let exact: BigInt = (big(a, b) * big(c, d) - big(a, near) * big(c, d)) * big(e, a) + big(a, c);
            if let Some(sign) = found.sign() {
                assert_eq!(Some(sign), exact.sign().cmp(&num_bigint::Sign::NoSign).into());
                decided += 1;
            }
            let scaled = |value: f64| BigInt::from(value.abs().ceil() as i128);
            if found.value.abs() < 1e37 {
                let middle = BigInt::from(found.value as i128);
                let distance = (exact - middle).magnitude().clone();
                assert!(BigInt::from(distance) <= scaled(found.error) + 1, "{found:?}");
            }
        }
        assert!((1_000..20_000).contains(&decided), "{decided}");
    }

    #[test]
    fn what_overflows_or_underflows_is_not_decided() {
        let (huge, tiny) = (Ball::difference(1e200, 0.0), Ball::difference(1e-200, 0.0));
        assert_eq!(huge.sign(), Some(Ordering::Greater));
        assert_eq!(tiny.sign(), Some(Ordering::Greater));
        assert_eq!(huge.times(&huge).sign(), None);
        assert_eq!(huge.times(&huge).minus(&huge.times(&huge)).sign(), None);
        assert_eq!(tiny.times(&tiny).sign(), None);
        assert_eq!(Ball::difference(-1e308, 1e308).sign(), None);
        assert_eq!(Ball::difference(1.0, 1.0).sign(), None);
    }
}

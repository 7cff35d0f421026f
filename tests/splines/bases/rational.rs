//! Simplex splines in rational numbers, by the recurrence on the first three knots that are not collinear.

use num_bigint::BigInt;
use num_traits::{Signed, ToPrimitive, Zero};

/// A quotient, not reduced.
#[derive(Clone)]
pub struct Rational {
    over: BigInt,
    under: BigInt,
}

impl Rational {
    fn plus(&self, other: &Rational) -> Rational {
        let over = &self.over * &other.under + &other.over * &self.under;
        Rational { over, under: &self.under * &other.under }
    }

    fn times(&self, over: &BigInt, under: &BigInt) -> Rational {
        Rational { over: &self.over * over, under: &self.under * under }
    }

    /// The nearest f64, up to a bit or two.
    pub fn rounded(&self) -> f64 {
        if self.over.is_zero() {
            return 0.0;
        }
        let shift = 80 + self.under.bits() as i64 - self.over.bits() as i64;
        let quotient = if shift >= 0 {
            (&self.over << shift) / &self.under
        } else {
            &self.over / (&self.under << -shift)
        };
        quotient.to_f64().expect("a number") * 2f64.powi(-shift as i32)
    }
}

/// Twice the area of abc.
pub fn doubled_area(a: [i64; 2], b: [i64; 2], c: [i64; 2]) -> BigInt {
    let d = |p: i64, q: i64| BigInt::from(p) - BigInt::from(q);
    d(b[0], a[0]) * d(c[1], a[1]) - d(b[1], a[1]) * d(c[0], a[0])
}

/// M(x | knots). Panics if x is on a line through two knots.
pub fn simplex_spline(x: [i64; 2], knots: &[[i64; 2]]) -> Rational {
    let zero = Rational { over: BigInt::zero(), under: BigInt::from(1) };
    let count = knots.len();
    let triples = (0..count).flat_map(|i| (0..i).flat_map(move |j| (0..j).map(move |k| [k, j, i])));
    let size = |&[i, j, k]: &[usize; 3]| doubled_area(knots[i], knots[j], knots[k]);
    let Some(triple) = triples.into_iter().find(|triple| !size(triple).is_zero()) else { return zero };
    let whole = size(&triple);
    let [a, b, c] = triple.map(|place| knots[place]);
    let parts = [doubled_area(x, b, c), doubled_area(a, x, c), doubled_area(a, b, x)];
    assert!(parts.iter().all(|part| !part.is_zero()), "{x:?} is on a line through knots");
    if count == 3 {
        let is_inside = parts.iter().all(|part| part.is_positive() == whole.is_positive());
        return if is_inside { Rational { over: BigInt::from(2), under: whole.abs() } } else { zero };
    }
    triple.into_iter().zip(parts).fold(zero, |sum, (place, part)| {
        let others = [&knots[..place], &knots[place + 1..]].concat();
        sum.plus(&simplex_spline(x, &others).times(&part, &whole))
    })
}

//! Sums without rounding: what is added is rounded once, so neither order nor division of the terms matters.

use num_bigint::BigInt;

use super::Real;

/// Binary digits behind the point.
const FRACTION_BITS: i32 = 64;

/// Terms are divided at this power of two, so that both parts fit 128 bits.
const CARRY_BITS: i32 = 32;
const CARRY: f64 = (1u64 << CARRY_BITS) as f64;

/// The number of units in one, 2^64, and the other way round.
const UNITS: f64 = 18_446_744_073_709_551_616.0;
pub(super) const UNIT: f64 = 1.0 / UNITS;

/// The fine part is carried from here on; terms have fewer than 98 bits.
const FINE_MAX: u128 = 1 << 120;

/// A sum of multiples of 2^-64.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Sum {
    /// In units of 2^32.
    coarse: i128,
    /// In units of 2^-64.
    fine: i128,
}

impl Sum {
    /// Adds a term, rounded to the nearest unit, half away from zero: a term and its negative cancel.
    ///
    /// Domain: at most 2^150.
    #[inline]
    pub(super) fn add(&mut self, term: Real) {
        let (high, low) = (self.carried(term.0), self.carried(term.1));
        // Scaling by a power of two is exact. A high part with a fraction leaves less than a unit behind it.
        let (high, low) = (high * UNITS, low * UNITS);
        let whole = high.trunc();
        self.fine += whole as i128 + ((high - whole) + low).round() as i128;
        if self.fine.unsigned_abs() > FINE_MAX {
            self.carry();
        }
    }

    /// Adds what is coarse of a part of a term, and returns what is left of it: less than 2^32.
    #[inline]
    fn carried(&mut self, part: f64) -> f64 {
        if part.abs() < CARRY {
            return part;
        }
        let carried = (part / CARRY).trunc();
        self.coarse += carried as i128;
        part - carried * CARRY
    }

    #[cold]
    fn carry(&mut self) {
        let carried = self.fine >> (CARRY_BITS + FRACTION_BITS);
        self.coarse += carried;
        self.fine -= carried << (CARRY_BITS + FRACTION_BITS);
    }

    /// Adds another sum.
    pub(super) fn merge(&mut self, other: &Sum) {
        self.coarse += other.coarse;
        self.fine += other.fine;
        self.carry();
    }

    /// The number of units.
    pub(super) fn units(&self) -> BigInt {
        (BigInt::from(self.coarse) << (CARRY_BITS + FRACTION_BITS) as u32) + self.fine
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_cancel_in_any_order_and_of_any_size() {
        let mut random = spmesh_base::random::Random::new(7);
        let mut term = || {
            let high = (random.unit() - 0.5) * 2f64.powi(random.below(150) as i32 - 30);
            spmesh_delaunay::predicates::Pair(high, (random.unit() - 0.5) * high * f64::EPSILON)
        };
        let terms: Vec<Real> = (0..10_000).map(|_| term()).collect();
        let (mut sum, mut turned) = (Sum::default(), Sum::default());
        terms.iter().for_each(|&term| sum.add(term));
        terms.iter().rev().for_each(|&term| turned.add(-term));
        assert_eq!(sum.units(), -turned.units());
        sum.merge(&turned);
        assert_eq!(sum.units(), BigInt::ZERO);
    }

    #[test]
    fn terms_are_rounded_once() {
        for (high, low, units) in [
            (1.0, 0.0, 1i128 << 64),
            (-3.0, 2f64.powi(-60), -(3i128 << 64) + 16),
            (2f64.powi(-65), 0.0, 1),
            (-(2f64.powi(-65)), 0.0, -1),
            (2f64.powi(-66), 0.0, 0),
            (2f64.powi(60) + 4096.0, -1.0, ((1i128 << 60) + 4095) << 64),
        ] {
            let mut sum = Sum::default();
            sum.add(spmesh_delaunay::predicates::Pair(high, low));
            assert_eq!(sum.units(), BigInt::from(units), "{high} {low}");
        }
    }
}

//! Values of simplices, and their order: some 106 bits, and the exact fraction when these do not decide.

use std::cmp::Ordering;
use std::collections::HashMap;

use super::complex::Table;
use super::double::Double;
use super::orthosphere::Fraction;
use super::sites::{Sites, dimension};
use num_bigint::{BigInt, Sign};

/// Share of a value that is the greatest error of a [`Value`] in the range of normal numbers.
pub(super) const ERROR: f64 = 1.0 / (1u128 << 70) as f64;

/// Greatest error that a [`Value`] may have beside that, as it underflows.
const TINY: f64 = 1e-290;

/// A value, rounded: its error is at most [`ERROR`] of it. It is infinite if it overflows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Value {
    pub(super) high: f64,
    pub(super) low: f64,
}

impl Value {
    /// A value without error.
    pub(super) fn exactly(value: f64) -> Value {
        Value { high: value, low: 0.0 }
    }

    /// The quotient, if it is certain to be accurate enough.
    pub(super) fn of_doubles(fraction: &Fraction<Double>) -> Option<Value> {
        let Fraction { numerator, denominator } = *fraction;
        let [high, low] = numerator.over(denominator);
        // A quarter of the error for each of the operands leaves a half for the division.
        let is_accurate = numerator.is_within(ERROR / 4.0) && denominator.is_within(ERROR / 4.0);
        let is_normal = high.abs() > TINY && high.is_finite();
        (is_accurate && is_normal).then_some(Value { high, low })
    }

    /// The quotient times 4 to the power of `exponent`.
    pub(super) fn of_fraction(fraction: &Fraction<BigInt>, exponent: i32) -> Value {
        const DIGITS: i64 = 120;
        let Fraction { numerator, denominator } = fraction;
        if numerator.sign() == Sign::NoSign {
            return Value::exactly(0.0);
        }
        let shift = DIGITS - (numerator.bits() as i64 - denominator.bits() as i64);
        let (dividend, divisor) = (numerator.magnitude(), denominator.magnitude());
        let quotient = match usize::try_from(shift) {
            Ok(shift) => (dividend << shift) / divisor,
            Err(_) => dividend / (divisor << shift.unsigned_abs() as usize),
        };
        let quotient = u128::try_from(quotient).expect("about 120 bits");
        let high = quotient as f64;
        // Two steps, as the power of two may be out of the range of f64 where the result is not.
        let power = (2 * i64::from(exponent) - shift).clamp(-4000, 4000) as i32;
        let scaled = |part: f64| (0..4).fold(part, |part, step| part * 2f64.powi((power + step) >> 2));
        let (high, low) = (scaled(high), scaled((quotient as i128 - high as i128) as f64));
        if numerator.sign() == Sign::Minus { Value { high: -high, low: -low } } else { Value { high, low } }
    }

    /// An order of rounded values that contradicts that of the values only if they are [in
    /// doubt](Value::is_in_doubt).
    pub(super) fn rounded_order(&self, other: &Value) -> Ordering {
        self.high.total_cmp(&other.high).then(self.low.total_cmp(&other.low))
    }

    /// Whether another value, which is not less when rounded, may in truth be equal or less.
    pub(super) fn is_in_doubt(&self, greater: &Value) -> bool {
        let error = |value: &Value| value.high.abs() * (4.0 * ERROR) + TINY;
        let room = (greater.high - self.high) + (greater.low - self.low);
        // False also for values that overflow, with which the room is no number.
        let is_certain = room > error(self) + error(greater);
        !is_certain
    }
}

impl Fraction<BigInt> {
    /// Compares the exact quotients.
    pub(super) fn compare(&self, other: &Self) -> Ordering {
        (&self.numerator * &other.denominator).cmp(&(&other.numerator * &self.denominator))
    }
}

/// The numbers of simplices in order, in groups of equal value.
#[derive(Debug, Default)]
pub(super) struct Order {
    pub(super) numbers: Vec<u32>,
    /// Where each group ends.
    pub(super) ends: Vec<u32>,
}

/// Sorts the simplices of a table.
///
/// Rounded values decide where they can. What is left are runs of values in doubt, nearly all of which are
/// equal in truth; to see this takes one comparison for each.
///
/// Memory: 8 bytes per simplex; more only where values differ in no more than their last bits.
pub(super) fn order(sites: &Sites<'_>, table: &Table) -> Order {
    let mut numbers: Vec<u32> = (0..table.simplices.len() as u32).collect();
    let value = |number: u32| &table.values[number as usize];
    numbers.sort_unstable_by(|&a, &b| value(a).rounded_order(value(b)));
    let mut ends = Vec::new();
    let mut end = 0;
    let mut finish = |group: &mut [u32]| {
        group.sort_unstable_by_key(|&number| {
            let simplex = &table.simplices[number as usize];
            (dimension(simplex), *simplex)
        });
        end += group.len() as u32;
        ends.push(end);
    };
    for run in numbers.chunk_by_mut(|&a, &b| value(a).is_in_doubt(value(b))) {
        if are_equal(sites, table, run) {
            finish(run);
        } else {
            let fractions = fractions(sites, table, run);
            let fraction = |number: u32| &fractions[&table.carriers[number as usize]];
            run.sort_unstable_by(|&a, &b| fraction(a).compare(fraction(b)));
            run.chunk_by_mut(|&a, &b| fraction(a).compare(fraction(b)).is_eq()).for_each(&mut finish);
        }
    }
    Order { numbers, ends }
}

/// Whether the values of all simplices of a run are equal.
fn are_equal(sites: &Sites<'_>, table: &Table, run: &[u32]) -> bool {
    let carrier = |number: u32| table.carriers[number as usize];
    let fraction = |number: u32| sites.fraction(&table.simplices[carrier(number) as usize]);
    let Some((&first, others)) = run.split_first().filter(|(_, others)| !others.is_empty()) else {
        return true;
    };
    let mut equal = carrier(first);
    let mut exact = None;
    others.iter().all(|&number| {
        let is_equal = carrier(number) == equal
            || exact.get_or_insert_with(|| fraction(first)).compare(&fraction(number)).is_eq();
        equal = carrier(number);
        is_equal
    })
}

/// The exact values of the simplices of a run, by their carriers.
fn fractions(sites: &Sites<'_>, table: &Table, run: &[u32]) -> HashMap<u32, Fraction<BigInt>> {
    let carriers = run.iter().map(|&number| table.carriers[number as usize]);
    let mut fractions = HashMap::new();
    for carrier in carriers {
        fractions.entry(carrier).or_insert_with(|| sites.fraction(&table.simplices[carrier as usize]));
    }
    fractions
}

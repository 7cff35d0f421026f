//! The order of the filtration: by value, then by dimension, then by vertices.

use std::collections::HashMap;

use num_bigint::BigInt;

use super::complex::Table;
use super::orthosphere::Fraction;
use super::sites::{Sites, dimension};

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

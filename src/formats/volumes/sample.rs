//! Random choice without replacement.

use std::collections::HashSet;
use std::fmt;

use foldhash::fast::FixedState;

use crate::volumes::too_many;
use spmesh_base::allocator::may_fail;
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::limits::POINTS4_MAX;
use spmesh_base::random::Random;

/// How many points are chosen at random.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Share {
    /// This part of the points, between 0 and 1, rounded to the nearest number of points.
    Part(f64),
    /// This many points.
    Count(u64),
}

impl Share {
    /// Number of points to choose of `total`.
    pub(crate) fn of(self, total: u64) -> Result<u64> {
        let count = match self {
            // The conversion is exact: totals have at most 53 bits.
            Share::Part(part) => (part * total as f64).round() as u64,
            Share::Count(count) => count,
        };
        if count > total {
            return Err(Error::usage(format!("{count} points are to be chosen, but there are {total}")));
        }
        if count > POINTS4_MAX {
            return Err(too_many("points", count, POINTS4_MAX, "choose fewer with --sample or --count"));
        }
        Ok(count)
    }
}

impl fmt::Display for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Share::Part(part) => write!(f, "--sample {part}"),
            Share::Count(count) => write!(f, "--count {count}"),
        }
    }
}

/// Chooses `count` of the numbers below `total`, in increasing order; all sets of this size are equally
/// likely.
///
/// Cost: O(n log n) for n = `count`, independent of `total` (Floyd; Bentley and Floyd, Communications of the
/// ACM 1987).
pub(crate) fn choose(total: u64, count: u64, seed: u64) -> Result<Vec<u64>> {
    let no_memory = |_| Error::new(ErrorKind::Memory, format!("not enough memory to choose {count} points"));
    let mut random = Random::new(seed);
    let mut chosen = HashSet::with_hasher(FixedState::default());
    may_fail(|| chosen.try_reserve(count as usize)).map_err(no_memory)?;
    for last in total - count..total {
        let number = random.below(last + 1);
        if !chosen.insert(number) {
            chosen.insert(last);
        }
    }
    let mut sorted = Vec::new();
    may_fail(|| sorted.try_reserve_exact(count as usize)).map_err(no_memory)?;
    sorted.extend(chosen);
    sorted.sort_unstable();
    Ok(sorted)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_are_chosen_as_asked_for_and_none_twice() {
        for (total, count) in [(1, 0), (1, 1), (10, 10), (1000, 400), (1 << 40, 1000)] {
            let chosen = choose(total, count, 7).unwrap();
            assert_eq!(chosen.len() as u64, count);
            assert!(chosen.is_sorted_by(|a, b| a < b) && chosen.last().is_none_or(|&last| last < total));
            assert_eq!(chosen, choose(total, count, 7).unwrap());
        }
        assert_ne!(choose(1000, 400, 7).unwrap(), choose(1000, 400, 8).unwrap());
    }

    #[test]
    fn every_pair_is_about_as_likely() {
        let mut counts = std::collections::BTreeMap::new();
        for seed in 0..6000 {
            *counts.entry(choose(4, 2, seed).unwrap()).or_insert(0) += 1;
        }
        assert_eq!(counts.len(), 6);
        assert!(counts.values().all(|count| (850..1150).contains(count)), "{counts:?}");
    }

    #[test]
    fn shares_are_rounded() {
        assert_eq!(Share::Part(0.4).of(256).unwrap(), 102);
        assert_eq!(Share::Part(0.5).of(3).unwrap(), 2);
        assert_eq!(Share::Part(1.0).of(5).unwrap(), 5);
        assert_eq!(Share::Count(5).of(5).unwrap(), 5);
        assert!(Share::Count(6).of(5).is_err());
        assert!(Share::Part(1.0).of(1 << 40).is_err());
    }
}

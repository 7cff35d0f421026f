//! Differences of pairs of flight lines, of which memory holds a sample.

use std::collections::BTreeMap;

use super::figures::percentile;
use spmesh_base::random::mixed;

/// Bytes of a difference in the sample, and of the free place beside it while it grows.
const ITEM_LEN: u64 = 48;

/// Two flight lines, the one with the lower number first.
pub type Pair = [u16; 2];

/// Differences of some cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Differences {
    /// How many there are.
    pub cells: u64,
    /// Their mean.
    pub mean: f64,
    /// The root of their mean square.
    pub rmsd: f64,
    /// The 95th percentile of their absolute values.
    pub percentile95: f64,
    /// The greatest absolute value.
    pub greatest: f64,
}

#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    cells: u64,
    sum: f64,
    squares: f64,
    greatest: f64,
}

impl Sums {
    fn add(&mut self, other: Sums) {
        self.cells += other.cells;
        self.sum += other.sum;
        self.squares += other.squares;
        self.greatest = self.greatest.max(other.greatest);
    }

    fn differences(self, mut sizes: Vec<f64>) -> Differences {
        sizes.sort_unstable_by(f64::total_cmp);
        let count = self.cells as f64;
        Differences {
            cells: self.cells,
            mean: self.sum / count,
            rmsd: (self.squares / count).sqrt(),
            percentile95: if sizes.is_empty() { self.greatest } else { percentile(&sizes, 95.0) },
            greatest: self.greatest,
        }
    }
}

/// Sums of all differences, and a sample of them for percentiles: all of them, or those of one cell in 2, 4,
/// 8 and so on, chosen by a hash, as soon as memory has no room for more.
#[derive(Debug)]
pub(super) struct Sample {
    sums: BTreeMap<Pair, Sums>,
    items: Vec<(u64, Pair, f64)>,
    most: usize,
    /// Zero bits at the end of the hashes of chosen cells.
    zeros: u32,
}

impl Sample {
    /// No differences. `memory` is for the sample. Units: bytes.
    pub(super) fn new(memory: u64) -> Sample {
        let most = usize::try_from(memory / ITEM_LEN).unwrap_or(usize::MAX).max(1);
        Sample { sums: BTreeMap::new(), items: Vec::new(), most, zeros: 0 }
    }

    /// Adds the difference of a pair in a cell.
    pub(super) fn add(&mut self, pair: Pair, cell: [usize; 2], difference: f64) {
        let one =
            Sums { cells: 1, sum: difference, squares: difference * difference, greatest: difference.abs() };
        self.sums.entry(pair).or_default().add(one);
        let hash = hash(cell);
        if hash.trailing_zeros() < self.zeros {
            return;
        }
        self.items.push((hash, pair, difference.abs()));
        while self.items.len() > self.most && self.zeros < u64::BITS {
            self.zeros += 1;
            self.items.retain(|(hash, ..)| hash.trailing_zeros() >= self.zeros);
        }
    }

    /// The differences of all pairs, and of each; and of how many cells one is in the sample.
    pub(super) fn finish(self) -> (Option<Differences>, Vec<(Pair, Differences)>, u64) {
        let mut all = Sums::default();
        self.sums.values().for_each(|sums| all.add(*sums));
        let mut sizes: BTreeMap<Pair, Vec<f64>> = BTreeMap::new();
        self.items.iter().for_each(|&(_, pair, size)| sizes.entry(pair).or_default().push(size));
        let total = self.items.iter().map(|item| item.2).collect();
        let each = self
            .sums
            .into_iter()
            .map(|(pair, sums)| (pair, sums.differences(sizes.remove(&pair).unwrap_or_default())));
        let each = each.collect();
        (
            (all.cells > 0).then(|| all.differences(total)),
            each,
            1u64.checked_shl(self.zeros).unwrap_or(u64::MAX),
        )
    }
}

/// Scatters the bits of a cell.
fn hash([column, row]: [usize; 2]) -> u64 {
    mixed((column as u64) << 32 ^ row as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_has_sums_of_all() {
        let (mut small, mut large) = (Sample::new(100 * ITEM_LEN), Sample::new(u64::MAX));
        for number in 0..10_000 {
            let difference = (number % 101) as f64 / 100.0 - 0.5;
            for sample in [&mut small, &mut large] {
                sample.add([1, 2 + (number % 2) as u16], [number % 97, number / 97], difference);
            }
        }
        let ((some, pairs, one_in), (all, of_all, one)) = (small.finish(), large.finish());
        let (some, all) = (some.unwrap(), all.unwrap());
        assert!(one_in >= 128 && one == 1 && pairs.len() == 2 && of_all.len() == 2);
        assert_eq!((some.cells, some.mean, some.rmsd), (10_000, all.mean, all.rmsd));
        assert!((some.percentile95 - all.percentile95).abs() < 0.1, "{some:?} {all:?}");
        assert!((all.percentile95 - 0.48).abs() < 0.011, "{all:?}");
    }
}

//! Least-significant-digit radix sort of keys with an index.

use crate::huge_pages;
use std::cmp::Ordering;

/// A key and the index of what it belongs to.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Keyed {
    /// What is sorted by.
    pub key: u64,
    /// What is sorted.
    pub index: u32,
}

const DIGIT_BITS_MAX: u32 = 11;
const DIGIT_VALUES: usize = 1 << DIGIT_BITS_MAX;
const DIGITS_MAX: u32 = 3;
/// So many leading bits more than the number of items has are sorted by counting: then few items have an equal in
/// them, and those are sorted by comparison.
const SPARE_BITS: u32 = 6;

/// Reusable buffers of the sort.
#[derive(Debug, Default)]
pub struct RadixSort {
    items: Vec<Keyed>,
    scratch: Vec<Keyed>,
}

/// Which bits of the keys are sorted by counting.
#[derive(Clone, Copy)]
struct Digits {
    /// The lowest of them.
    shift: u32,
    /// Their number in a digit.
    bits: u32,
    /// Number of digits.
    count: u32,
}

impl Digits {
    /// For `items` items, with keys of up to `key_bits` bits.
    fn of(items: usize, key_bits: u32) -> Digits {
        let wanted = (items.max(1).ilog2() + 1 + SPARE_BITS).min(DIGITS_MAX * DIGIT_BITS_MAX).min(key_bits);
        let count = wanted.div_ceil(DIGIT_BITS_MAX);
        let bits = wanted.div_ceil(count.max(1));
        Digits { shift: key_bits.saturating_sub(count * bits), bits, count }
    }

    /// Digit number `digit` of `key`, from the lowest.
    #[inline(always)]
    fn value(self, key: u64, digit: u32) -> usize {
        (key >> (self.shift + digit * self.bits)) as usize & ((1 << self.bits) - 1)
    }
}

impl RadixSort {
    /// The items to be sorted, to be filled before [`RadixSort::sort`]: empty, with room for `count`.
    pub fn items(&mut self, count: usize) -> &mut Vec<Keyed> {
        huge_pages::reserve(&mut self.items, count);
        &mut self.items
    }

    /// Sorts the items by key, and those of equal keys by `tie`.
    ///
    /// Cost: O(n) for keys that differ in their leading bits, a few more than it takes to number them;
    /// O(n log n) at worst.
    pub fn sort(&mut self, tie: impl Fn(&Keyed, &Keyed) -> Ordering) -> &[Keyed] {
        let used = self.items.iter().fold(0, |bits, item| bits | item.key);
        let digits = Digits::of(self.items.len(), u64::BITS - used.leading_zeros());
        let counts = self.digit_counts(digits);
        if self.scratch.len() < self.items.len() {
            huge_pages::reserve(&mut self.scratch, self.items.len());
        }
        self.scratch.resize(self.items.len(), Keyed::default());
        for (digit, counts) in (0..digits.count).zip(&counts) {
            if !counts.iter().any(|&count| count as usize == self.items.len()) {
                scatter(&self.items, &mut self.scratch, counts, |key| digits.value(key, digit));
                std::mem::swap(&mut self.items, &mut self.scratch);
            }
        }
        let groups = self.items.chunk_by_mut(|a, b| a.key >> digits.shift == b.key >> digits.shift);
        for group in groups.filter(|group| group.len() > 1) {
            group.sort_unstable_by(|a, b| a.key.cmp(&b.key).then_with(|| tie(a, b)));
        }
        &self.items
    }

    fn digit_counts(&self, digits: Digits) -> [[u32; DIGIT_VALUES]; DIGITS_MAX as usize] {
        let mut counts = [[0; DIGIT_VALUES]; DIGITS_MAX as usize];
        for item in &self.items {
            for (digit, counts) in (0..digits.count).zip(&mut counts) {
                counts[digits.value(item.key, digit)] += 1;
            }
        }
        counts
    }
}

/// Moves each item to its place by a digit of its key, keeping the order of equal digits.
fn scatter(from: &[Keyed], to: &mut [Keyed], counts: &[u32; DIGIT_VALUES], digit: impl Fn(u64) -> usize) {
    let mut next = 0;
    let mut places = counts.map(|count| {
        let place = next;
        next += count;
        place
    });
    for item in from {
        let place = &mut places[digit(item.key)];
        to[*place as usize] = *item;
        *place += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sorts_like_the_standard_library() {
        let mut state = 1u64;
        for mask in
            [u64::MAX, 0xff, 0, 0xffff_0000_0000_0000, 0x8000_0000_0000_0001, (1 << 33) - 1, 1 << 40 | 7]
        {
            for count in [0, 1, 2, 3, 1000] {
                let mut sort = RadixSort::default();
                sort.items(count as usize).extend((0..count).map(|index| {
                    state =
                        state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    Keyed { key: (state ^ state >> 29) & mask, index }
                }));
                let mut expected: Vec<u64> = sort.items.iter().map(|item| item.key).collect();
                expected.sort_unstable();
                let sorted = sort.sort(|a, b| a.index.cmp(&b.index));
                assert!(sorted.iter().map(|item| item.key).eq(expected), "mask {mask:x}, {count} items");
                let mut indices: Vec<u32> = sorted.iter().map(|item| item.index).collect();
                indices.sort_unstable();
                assert!(indices.into_iter().eq(0..count));
            }
        }
    }
}

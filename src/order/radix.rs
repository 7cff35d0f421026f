//! Least-significant-digit radix sort of keys with an index.

/// A key and the index of what it belongs to.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Keyed {
    /// What is sorted by.
    pub key: u64,
    /// What is sorted.
    pub index: u32,
}

const DIGIT_BITS: u32 = 11;
const DIGIT_VALUES: usize = 1 << DIGIT_BITS;
/// Digits sorted by counting, from the highest bit in use. Three tell 8.6e9 cells apart: few keys of real data are
/// left equal in them, and those are sorted by comparison.
const DIGITS: usize = 3;

/// Reusable buffers of the sort.
#[derive(Debug, Default)]
pub struct RadixSort {
    items: Vec<Keyed>,
    scratch: Vec<Keyed>,
}

impl RadixSort {
    /// The items to be sorted: clear and fill before [`RadixSort::sort`].
    pub fn items(&mut self) -> &mut Vec<Keyed> {
        &mut self.items
    }

    /// Sorts the items by key; the order of equal keys is unspecified. Digits that are constant cost nothing.
    ///
    /// Cost: O(n) for keys that differ in their leading 33 bits, O(n log n) at worst.
    pub fn sort(&mut self) -> &mut [Keyed] {
        let used = self.items.iter().fold(0, |bits, item| bits | item.key);
        let used_bits = u64::BITS - used.leading_zeros();
        let shift = used_bits.saturating_sub(DIGITS as u32 * DIGIT_BITS);
        let counts = self.digit_counts(shift);
        self.scratch.resize(self.items.len(), Keyed::default());
        for (digit, counts) in counts.iter().enumerate() {
            if !counts.iter().any(|&count| count as usize == self.items.len()) {
                scatter(&self.items, &mut self.scratch, shift + digit as u32 * DIGIT_BITS, counts);
                std::mem::swap(&mut self.items, &mut self.scratch);
            }
        }
        if shift > 0 {
            let ties = self.items.chunk_by_mut(|a, b| a.key >> shift == b.key >> shift);
            for tie in ties.filter(|tie| tie.len() > 1) {
                tie.sort_unstable_by_key(|item| item.key);
            }
        }
        &mut self.items
    }

    fn digit_counts(&self, shift: u32) -> [[u32; DIGIT_VALUES]; DIGITS] {
        let mut counts = [[0; DIGIT_VALUES]; DIGITS];
        for item in &self.items {
            let mut key = item.key >> shift;
            for counts in &mut counts {
                counts[key as usize % DIGIT_VALUES] += 1;
                key >>= DIGIT_BITS;
            }
        }
        counts
    }
}

/// Moves each item to its place by the digit at `shift`, keeping the order of equal digits.
fn scatter(from: &[Keyed], to: &mut [Keyed], shift: u32, counts: &[u32; DIGIT_VALUES]) {
    let mut next = 0;
    let mut places = counts.map(|count| {
        let place = next;
        next += count;
        place
    });
    for item in from {
        let place = &mut places[(item.key >> shift) as usize % DIGIT_VALUES];
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
                sort.items().extend((0..count).map(|index| {
                    state =
                        state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    Keyed { key: (state ^ state >> 29) & mask, index }
                }));
                let mut expected: Vec<u64> = sort.items().iter().map(|item| item.key).collect();
                expected.sort_unstable();
                let sorted = sort.sort();
                assert!(sorted.iter().map(|item| item.key).eq(expected), "mask {mask:x}, {count} items");
                let mut indices: Vec<u32> = sorted.iter().map(|item| item.index).collect();
                indices.sort_unstable();
                assert!(indices.into_iter().eq(0..count));
            }
        }
    }
}

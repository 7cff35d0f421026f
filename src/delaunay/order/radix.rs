//! Radix sort of keys with an index, packed in one word.

use std::ops::AddAssign;

use bytemuck::{Pod, Zeroable};

const DIGIT_BITS_MAX: u32 = 11;
const DIGITS_MAX: u32 = u32::BITS.div_ceil(DIGIT_BITS_MAX);

/// A key and the index of what it belongs to: the key is in the upper half.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
#[repr(transparent)]
pub(super) struct Keyed(u64);

// SAFETY: zero is a value of every field.
unsafe impl Zeroable for Keyed {}
// SAFETY: it is a number.
unsafe impl Pod for Keyed {}

impl Keyed {
    #[inline(always)]
    pub(super) fn new(key: u32, index: u32) -> Keyed {
        Keyed(u64::from(key) << 32 | u64::from(index))
    }

    #[inline(always)]
    pub(super) fn key(self) -> u32 {
        (self.0 >> 32) as u32
    }

    #[inline(always)]
    pub(super) fn index(self) -> u32 {
        self.0 as u32
    }
}

/// Sorts items by keys of `key_bits` bits, keeping the order of those with equal keys; they end up in one of
/// the two slices, which are equally long.
pub(super) fn sort<'m>(items: &'m mut [Keyed], scratch: &'m mut [Keyed], key_bits: u32) -> &'m mut [Keyed] {
    let digits = key_bits.div_ceil(DIGIT_BITS_MAX).max(1);
    let width = key_bits.div_ceil(digits);
    let digit = |item: Keyed, number: u32| (item.key() >> (number * width)) as usize & ((1 << width) - 1);
    let mut places = [[0u32; 1 << DIGIT_BITS_MAX]; DIGITS_MAX as usize];
    for &item in &*items {
        for (number, places) in (0..digits).zip(&mut places) {
            places[digit(item, number)] += 1;
        }
    }
    let (mut from, mut to) = (items, scratch);
    for (number, places) in (0..digits).zip(&mut places) {
        sizes_to_starts(&mut places[..1 << width]);
        for &item in &*from {
            let place = &mut places[digit(item, number)];
            to[*place as usize] = item;
            *place += 1;
        }
        std::mem::swap(&mut from, &mut to);
    }
    from
}

/// Replaces the size of each group by the place where the group starts, if the groups follow each other.
#[inline]
pub fn sizes_to_starts<T: Copy + Default + AddAssign>(groups: &mut [T]) {
    let mut next = T::default();
    for group in groups {
        next += std::mem::replace(group, next);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sorts_like_the_standard_library_and_keeps_the_order_of_equals() {
        let mut state = 1u64;
        for bits in [0, 1, 5, 11, 12, 22, 23, 31, 32] {
            for count in [0, 1, 2, 3, 1000, 5000] {
                let random = (0..count).map(|index| {
                    state =
                        state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    Keyed::new((state >> 32).checked_shr(32 - bits).unwrap_or(0) as u32, index)
                });
                let mut items: Vec<Keyed> = random.collect();
                let mut expected = items.clone();
                expected.sort_unstable();
                let mut scratch = items.clone();
                assert_eq!(sort(&mut items, &mut scratch, bits), expected, "{bits} bits, {count} items");
            }
        }
    }
}

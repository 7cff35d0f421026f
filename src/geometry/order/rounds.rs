//! Rounds of insertion, each of which covers the whole set of points.

/// The stride of the first round is `1 << FIRST`.
const FIRST: u32 = 9;

/// Each round makes a stride of the one before `1 << FACTOR` times shorter, down to 1.
const FACTOR: u32 = 3;
const _: () = assert!(FIRST.is_multiple_of(FACTOR));

/// The numbers from 0 to `count - 1`, which are places along a curve: every 512th first, then every 64th,
/// every 8th, and the rest.
///
/// Each round spreads over the whole set and makes an eighth of the next, so that a point finds small
/// simplices around it, as in a random order; within a round the next point is near.
#[derive(Debug, Clone)]
pub struct Rounds {
    next: usize,
    shift: u32,
    count: usize,
    /// How many numbers are still to come.
    left: usize,
}

impl Rounds {
    /// The rounds of `count` points.
    ///
    /// Domain: `count` at most 2^32.
    #[must_use]
    pub fn new(count: usize) -> Rounds {
        Rounds { next: 0, shift: FIRST, count, left: count }
    }
}

impl Iterator for Rounds {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        self.left = self.left.checked_sub(1)?;
        while self.next >= self.count {
            self.shift -= FACTOR;
            self.next = 1 << self.shift;
        }
        let number = self.next as u32;
        self.next += 1 << self.shift;
        let is_in = self.shift < FIRST && self.next & ((1 << (self.shift + FACTOR)) - 1) == 0;
        if is_in {
            self.next += 1 << self.shift;
        }
        Some(number)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.left, Some(self.left))
    }
}

impl ExactSizeIterator for Rounds {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_comes_once_in_the_first_round_that_has_it() {
        for count in [0u32, 1, 2, 8, 9, 63, 64, 65, 511, 512, 513, 5000] {
            let round =
                |number: &u32| [512, 64, 8, 1].iter().position(|stride| number.is_multiple_of(*stride));
            let mut expected: Vec<u32> = (0..count).collect();
            expected.sort_by_key(round);
            let rounds = Rounds::new(count as usize);
            assert_eq!(rounds.len(), count as usize);
            assert_eq!(rounds.collect::<Vec<u32>>(), expected, "{count}");
        }
    }
}

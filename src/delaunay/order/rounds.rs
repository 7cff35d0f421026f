//! Rounds of insertion, each of which covers the whole set of points, or a window of it.

use std::ops::Range;

/// The first round has a number of each block of `1 << FIRST`.
const FIRST: u32 = 9;

/// Each round divides the blocks of the one before into `1 << FACTOR` parts, down to single numbers.
const FACTOR: u32 = 3;
const _: () = assert!(FIRST.is_multiple_of(FACTOR));

/// Numbers of a window ([`Rounds::in_windows`]): the triangles around as many vertices fit into a cache of
/// the second level.
const WINDOW: usize = 1 << 13;
const _: () = assert!(WINDOW.is_multiple_of(1 << FIRST));

/// No block.
const NONE: usize = usize::MAX;

/// The numbers from 0 to `count - 1`, which are places along a curve: of each block of 512 one number first,
/// then one of each block of 64, one of each block of 8, and the rest. Each round goes along the curve.
///
/// Each round spreads over the whole set and makes an eighth of the next, so that a point finds small
/// simplices around it, as in a random order; within a round the next point is near.
///
/// Which number of a block comes first changes along the curve. If it were always the same, points in two
/// rows that take turns along the curve would come one row after the other, and each point of the second row
/// would be joined to all of the first.
#[derive(Debug, Clone)]
pub struct Rounds {
    /// The block of the next number, in blocks of `1 << shift`, and the number of these blocks.
    block: usize,
    end: usize,
    shift: u32,
    /// Of the blocks around `block` that are one of the round before, the one that had its number.
    had: usize,
    count: usize,
    /// The numbers of the rounds after the first, in part: the next window starts where this one ends.
    window: Range<usize>,
    window_len: usize,
    /// How many numbers are still to come.
    left: usize,
}

impl Rounds {
    /// The rounds of `count` points.
    ///
    /// Domain: `count` at most 2^32.
    pub fn new(count: usize) -> Rounds {
        Rounds {
            block: 0,
            end: count.div_ceil(1 << FIRST),
            shift: FIRST,
            had: NONE,
            count,
            window: 0..count,
            window_len: count,
            left: count,
        }
    }

    /// The same rounds, but after the first, each window of 8192 numbers has all its rounds before the next
    /// window. So these rounds find what they need in a cache.
    ///
    /// Domain: `count` at most 2^32.
    pub fn in_windows(count: usize) -> Rounds {
        Rounds { window: 0..count.min(WINDOW), window_len: WINDOW, ..Rounds::new(count) }
    }

    /// Begins the next round, of the whole set or of a window.
    fn begin(&mut self) {
        self.shift = match self.shift {
            0 => {
                let start = self.window.end;
                self.window = start..self.count.min(start + self.window_len);
                FIRST - FACTOR
            }
            shift => shift - FACTOR,
        };
        self.block = self.window.start >> self.shift;
        self.end = self.window.end.div_ceil(1 << self.shift);
    }
}

impl Iterator for Rounds {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        self.left = self.left.checked_sub(1)?;
        loop {
            if self.block == self.end {
                self.begin();
            }
            let block = self.block;
            self.block += 1;
            if block.is_multiple_of(1 << FACTOR) && self.shift < FIRST {
                self.had = block + first_part(block >> FACTOR);
            }
            if block == self.had {
                continue;
            }
            if self.shift == 0 {
                return Some(block as u32);
            }
            let number = first_of(block, self.shift);
            if number < self.count {
                return Some(number as u32);
            }
        }
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.left, Some(self.left))
    }
}

impl ExactSizeIterator for Rounds {}

/// The number of a block, of `1 << shift` numbers, that comes first.
#[inline]
fn first_of(mut block: usize, shift: u32) -> usize {
    for _ in 0..shift / FACTOR {
        block = block << FACTOR | first_part(block);
    }
    block
}

/// Which part of a block has its first number: the next one after every 8 blocks. Between these steps, the
/// numbers of a round are evenly spaced, which makes for the fewest simplices.
#[inline]
fn first_part(block: usize) -> usize {
    block >> FACTOR & ((1 << FACTOR) - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_comes_once() {
        for count in [0u32, 1, 2, 8, 9, 63, 64, 65, 511, 512, 513, 5000, 8192, 8193, 20_000] {
            for rounds in [Rounds::new(count as usize), Rounds::in_windows(count as usize)] {
                assert_eq!(rounds.len(), count as usize);
                let mut numbers: Vec<u32> = rounds.collect();
                numbers.sort_unstable();
                assert!(numbers.into_iter().eq(0..count), "{count}");
            }
        }
    }

    #[test]
    fn windows_have_the_rounds_of_the_whole_set_one_after_the_other() {
        let count = 2 * WINDOW + 3000;
        let whole: Vec<u32> = Rounds::new(count).collect();
        let first = count.div_ceil(1 << FIRST);
        let window = |number: &u32| *number as usize / WINDOW;
        let mut expected = whole[..first].to_vec();
        for number in 0..3 {
            expected.extend(whole[first..].iter().filter(|&n| window(n) == number));
        }
        assert_eq!(Rounds::in_windows(count).collect::<Vec<_>>(), expected);
    }

    #[test]
    fn each_round_has_a_number_of_each_block_and_goes_along_the_curve() {
        let numbers: Vec<u32> = Rounds::new(1 << 15).collect();
        let (mut from, mut seen) = (0, 0);
        for shift in [9, 6, 3, 0] {
            seen = (1 << 15) >> shift;
            assert!(numbers[from..seen].is_sorted(), "{shift}");
            let mut blocks: Vec<u32> = numbers[..seen].iter().map(|number| number >> shift).collect();
            blocks.sort_unstable();
            assert!(blocks.into_iter().eq(0..seen as u32), "{shift}");
            from = seen;
        }
        assert_eq!(seen, numbers.len());
    }

    /// Numbers of two rows that take turns must not come one row after the other; nor any few rows.
    #[test]
    fn rounds_take_turns_in_no_pattern() {
        let count = 1 << 17;
        for shift in [9, 6, 3] {
            let first: Vec<u32> = Rounds::new(count).take(count >> shift).collect();
            for rows in 2..=16 {
                let mut sizes = vec![0usize; rows];
                first.iter().for_each(|number| sizes[*number as usize % rows] += 1);
                let even = first.len() / rows;
                assert!(
                    sizes.iter().all(|size| size.abs_diff(even) < 5 * even.isqrt()),
                    "{shift}: {sizes:?}"
                );
            }
        }
    }
}

//! The sequence in which points along a curve are inserted.

use super::levels::{BIT_LEVEL_MAX, BitLevels, Suffixes};
use super::radix::sizes_to_starts;
use super::rounds::Rounds;
use crate::random::Random;
use std::ops::Range;

/// The sequence in which points are inserted that are stored along a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Sequence {
    /// In [`Rounds`] along the curve.
    #[default]
    Rounds,
    /// Once along the curve.
    Pass,
    /// At random, each sequence with the same probability.
    Random {
        /// The same seed gives the same sequence.
        seed: u64,
    },
}

impl Sequence {
    /// The numbers from 0 to `count - 1`, which are places along the curve, in this sequence.
    ///
    /// Domain: `count` at most 2^32. Cost: nothing; `Random`: O(n), 4 bytes per point.
    pub fn of(self, count: usize) -> Insertions {
        Insertions(match self {
            Sequence::Rounds => Form::Rounds(Rounds::new(count)),
            Sequence::Pass => Form::Pass(0..count as u64),
            Sequence::Random { seed } => Form::Stored(shuffled(count, seed).into_iter()),
        })
    }

    /// The numbers of `points`, which are stored along a curve, by their [`BitLevels`], the highest first;
    /// those of one level in this sequence.
    ///
    /// All points inserted so far then have as many bits in common as the level of the last one says. Where
    /// the thesis (3.4.1) has them in "reverse order", it calls level 0 the first, which contradicts its
    /// purpose.
    ///
    /// Domain: finite coordinates, at most 2^32 points. Cost: O(n), 5 bytes per point.
    pub fn by_levels<const D: usize>(self, points: &[[f64; D]], suffixes: Suffixes) -> Insertions {
        let bit_levels = BitLevels::of(points, suffixes);
        let rank = |point: &[f64; D]| (BIT_LEVEL_MAX - bit_levels.level(*point)) as u8;
        let ranks: Vec<u8> = points.iter().map(rank).collect();
        let mut places = [0usize; BIT_LEVEL_MAX as usize + 1];
        ranks.iter().for_each(|&rank| places[usize::from(rank)] += 1);
        sizes_to_starts(&mut places);
        let mut stored = vec![0; points.len()];
        for number in self.of(points.len()) {
            let place = &mut places[usize::from(ranks[number as usize])];
            stored[*place] = number;
            *place += 1;
        }
        Insertions(Form::Stored(stored.into_iter()))
    }
}

/// Numbers of points in the sequence of their insertion.
#[derive(Debug, Clone)]
pub struct Insertions(Form);

#[derive(Debug, Clone)]
enum Form {
    Rounds(Rounds),
    Pass(Range<u64>),
    Stored(std::vec::IntoIter<u32>),
}

impl Insertions {
    /// These numbers, in this order.
    pub fn listed(numbers: Vec<u32>) -> Insertions {
        Insertions(Form::Stored(numbers.into_iter()))
    }
}

impl Iterator for Insertions {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        match &mut self.0 {
            Form::Rounds(rounds) => rounds.next(),
            Form::Pass(numbers) => numbers.next().map(|number| number as u32),
            Form::Stored(numbers) => numbers.next(),
        }
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        match &self.0 {
            Form::Rounds(rounds) => rounds.size_hint(),
            Form::Pass(numbers) => numbers.size_hint(),
            Form::Stored(numbers) => numbers.size_hint(),
        }
    }
}

impl ExactSizeIterator for Insertions {}

/// The numbers from 0 to `count - 1` in random order.
fn shuffled(count: usize, seed: u64) -> Vec<u32> {
    let mut numbers: Vec<u32> = (0..count as u64).map(|number| number as u32).collect();
    Random::new(seed).shuffle(&mut numbers);
    numbers
}

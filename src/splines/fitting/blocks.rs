//! Scattered observations, read as often as a fit needs them, in blocks of a fixed size, several at a time.
//!
//! Blocks are cut by the numbers of observations, independently of the batches of the source, and their
//! results return in order. So no result depends on the number of threads.

use std::num::NonZeroUsize;

use spmesh_base::error::{Error, Result};
use spmesh_delaunay::parallel;
use spmesh_delaunay::predicates::Point2;

/// Observations in a block.
const BLOCK: usize = 1 << 13;
/// Blocks per thread that are read ahead, which bounds the memory of a pass.
const BLOCKS_PER_THREAD: usize = 4;

/// Consecutive observations.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block<'a> {
    /// The number of the first observation.
    pub(super) first: u64,
    pub(super) observations: &'a [Observation],
}

impl<'a> Block<'a> {
    /// Observations with their numbers.
    pub(super) fn numbered(self) -> impl Iterator<Item = (u64, &'a Observation)> {
        (self.first..).zip(self.observations)
    }
}

/// Reads all observations. `map` processes each block in any thread; `take` receives the results of
/// consecutive blocks in order.
pub(super) fn for_each_round<O: Observations + ?Sized, T: Send>(
    observations: &O,
    threads: NonZeroUsize,
    map: impl Fn(Block) -> Result<T> + Sync,
    mut take: impl FnMut(Vec<T>) -> Result<()>,
) -> Result<()> {
    let mut reader = observations.read()?;
    let round = BLOCK * BLOCKS_PER_THREAD * threads.get();
    let (mut first, mut buffer) = (0u64, Vec::new());
    loop {
        let is_last = fill(&mut buffer, round, |buffer| reader.append(buffer))?;
        let whole = if is_last { buffer.len() } else { buffer.len() - buffer.len() % BLOCK };
        let blocks: Vec<Block> = (first..)
            .step_by(BLOCK)
            .zip(buffer[..whole].chunks(BLOCK))
            .map(|(first, observations)| Block { first, observations })
            .collect();
        let made = parallel::map(threads, blocks, |block| {
            block.numbered().try_for_each(|(index, observation)| observation.check(index))?;
            map(block)
        });
        take(made?)?;
        if is_last {
            return Ok(());
        }
        first += whole as u64;
        buffer.drain(..whole);
    }
}

/// Appends until there are `enough`; returns whether the source has ended.
fn fill<T>(
    buffer: &mut Vec<T>,
    enough: usize,
    mut append: impl FnMut(&mut Vec<T>) -> Result<()>,
) -> Result<bool> {
    while buffer.len() < enough {
        let before = buffer.len();
        append(buffer)?;
        if buffer.len() == before {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Observations per batch of a list in memory.
const BATCH: usize = 1 << 13;

/// A value at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// The place of the observation.
    pub point: Point2,
    /// The measured value.
    pub value: f64,
    /// How much the observation counts: the reciprocal of a variance, or a number of equal observations. Not
    /// negative.
    pub weight: f64,
}

impl Observation {
    /// An observation of weight one.
    pub fn new(point: Point2, value: f64) -> Observation {
        Observation { point, value, weight: 1.0 }
    }

    /// Refuses invalid observations; `index` is the number of this one.
    pub(super) fn check(&self, index: u64) -> Result<()> {
        let refuse = |what: String| Err(Error::malformed(what).at(format!("observation {index}")));
        if !self.point.iter().all(|coordinate| coordinate.is_finite()) {
            return refuse(format!("coordinate is not finite: {:?}", self.point));
        }
        if !self.value.is_finite() {
            return refuse(format!("value is not finite: {}", self.value));
        }
        if !(self.weight >= 0.0 && self.weight.is_finite()) {
            return refuse(format!("weight {}: expected a finite number, not negative", self.weight));
        }
        Ok(())
    }
}

/// Observations that can be read several times, always in the same order.
pub trait Observations {
    /// Starts a pass over all of them.
    fn read(&self) -> Result<Box<dyn ObservationReader + '_>>;
}

/// One pass over observations.
pub trait ObservationReader {
    /// Appends the next observations; appends none at the end.
    fn append(&mut self, observations: &mut Vec<Observation>) -> Result<()>;
}

impl Observations for [Observation] {
    fn read(&self) -> Result<Box<dyn ObservationReader + '_>> {
        Ok(Box::new(Listed { rest: self }))
    }
}

impl Observations for Vec<Observation> {
    fn read(&self) -> Result<Box<dyn ObservationReader + '_>> {
        self.as_slice().read()
    }
}

/// The unread rest of a list.
struct Listed<'a> {
    rest: &'a [Observation],
}

impl ObservationReader for Listed<'_> {
    fn append(&mut self, observations: &mut Vec<Observation>) -> Result<()> {
        let (next, rest) = self.rest.split_at(self.rest.len().min(BATCH));
        observations.extend_from_slice(next);
        self.rest = rest;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_do_not_depend_on_threads() {
        let count = 3 * BLOCK * BLOCKS_PER_THREAD + 17;
        let all: Vec<Observation> = (0..count).map(|i| Observation::new([0.0; 2], i as f64)).collect();
        let seen = |threads| {
            let mut seen = Vec::new();
            let map = |block: Block| {
                assert!(block.numbered().all(|(index, observation)| observation.value == index as f64));
                Ok((block.first, block.observations.len()))
            };
            let take = |some| {
                seen.extend::<Vec<(u64, usize)>>(some);
                Ok(())
            };
            for_each_round(&all, NonZeroUsize::new(threads).unwrap(), map, take).unwrap();
            seen
        };
        let expected: Vec<(u64, usize)> =
            (0..count).step_by(BLOCK).map(|first| (first as u64, BLOCK.min(count - first))).collect();
        assert_eq!(seen(1), expected);
        assert_eq!(seen(2), expected);
        assert_eq!(seen(3), expected);
    }
}

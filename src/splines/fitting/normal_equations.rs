//! Normal equations of weighted least squares, in one pass over the observations.
//!
//! Let A have the values of functions at an observation as a row, W its weight on the diagonal, and z its
//! value. Then the coefficients c solve A'WA c = A'Wz. Memory: A'WA, about 10 entries per function of degree
//! 2, and a few blocks of observations.
//!
//! Each round has two steps. First, threads evaluate blocks of observations in parallel. Then each thread
//! adds all blocks, in their order, to the rows that it owns. So each entry is a sum in the order of
//! observations, whatever the number of threads.

use std::num::NonZeroUsize;

use super::blocks::{self, Block, Observation, Observations};
use super::polygon;
use super::symmetric::Symmetric;
use crate::bases::{Basis, Scratch};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::parallel;

/// Normal equations, with the sums that give the residuals.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalEquations {
    /// A'WA.
    pub matrix: Symmetric,
    /// A'Wz.
    pub right: Vec<f64>,
    /// z'Wz.
    pub square: f64,
    /// Sum of weights.
    pub weight: f64,
    /// Number of observations in the domain whose weight is not zero.
    pub count: u64,
    /// Number of observations outside of the domain of the basis, which are left out.
    pub outside: u64,
    /// The typical distance of observations, if their density varies; otherwise it is the root of the area of
    /// one. Units: those of coordinates.
    pub distance: Option<f64>,
}

/// The area of the domain of a basis.
pub fn domain_area(basis: &Basis) -> f64 {
    polygon::area(&basis.domain_corners())
}

impl NormalEquations {
    /// The equations of all observations.
    ///
    /// Cost: one pass, with one evaluation of the basis per observation.
    ///
    /// # Errors
    /// Those of the source; numbers that are not finite, or negative weights, with the number of the
    /// observation.
    pub fn of<O: Observations + ?Sized>(
        basis: &Basis,
        observations: &O,
        threads: NonZeroUsize,
    ) -> Result<NormalEquations> {
        Ok(Parts::unweighed(basis, observations, threads, 1, |_| 0)?.sum(|_| true))
    }

    /// The weighted sum of squared residuals for these coefficients. Accuracy: about 1e-15 of z'Wz.
    pub fn residual_square(&self, coefficients: &[f64]) -> f64 {
        let mixed: f64 = self.right.iter().zip(coefficients).map(|(right, c)| right * c).sum();
        (self.square - 2.0 * mixed + self.matrix.form(coefficients)).max(0.0)
    }

    /// The default `lambda`. It halves the amplitude of waves as long as two spacings of observations, the
    /// shortest that observations can resolve. It does not depend on knots. On terrain, about this value
    /// predicts held-out points best.
    ///
    /// A thin plate with total weight W on an area A multiplies waves of wave number k by
    /// 1 / (1 + lambda k^4 A / W). Here k is pi over the spacing, and n observations have a spacing of
    /// sqrt(A / n).
    pub fn default_lambda(&self, basis: &Basis) -> f64 {
        let area = self.area_per_observation(basis);
        self.weight * area / (self.count as f64 * std::f64::consts::PI.powi(4))
    }

    /// The area of the domain per observation, or the square of their typical distance.
    pub fn area_per_observation(&self, basis: &Basis) -> f64 {
        let even = || domain_area(basis) / self.count as f64;
        self.distance.map_or_else(even, |distance| distance * distance)
    }

    /// Refuses equations without observations, and values whose squares exceed f64.
    pub(super) fn check(&self) -> Result<()> {
        if !self.square.is_finite() {
            return Err(Error::usage("the squares of the values are too great for f64: scale the values"));
        }
        if self.count > 0 {
            return Ok(());
        }
        let what = match self.outside {
            0 => "no observations: nothing can be fitted".to_string(),
            outside => format!(
                "none of {outside} observations is in the domain of the knots: give knots that surround \
                 the data, \
                 in the same coordinates"
            ),
        };
        Err(Error::usage(what))
    }
}

/// The weight of an observation, and its residual if requested.
#[derive(Debug, Clone, Copy)]
pub(super) struct Weighed {
    pub(super) weight: f64,
    /// The residual and its cell, if the caller collects them.
    pub(super) residual: Option<(f64, u32)>,
}

/// Normal equations of several parts of the observations, from one pass.
#[derive(Debug, Clone)]
pub(super) struct Parts {
    rows: Rows,
    /// A'Wz: for each function, the values of all parts.
    right: Vec<f64>,
    totals: Vec<Totals>,
}

/// Sums over one part.
#[derive(Debug, Clone, Copy, Default)]
struct Totals {
    square: f64,
    weight: f64,
    count: u64,
    outside: u64,
}

/// Observations with the functions alive at them.
#[derive(Default)]
struct Evaluated {
    parts: Vec<u32>,
    /// Weights and values of observations.
    weighted: Vec<[f64; 2]>,
    offsets: Vec<u32>,
    alive: Vec<(u32, f64)>,
    residuals: Vec<(f64, u32)>,
    totals: Vec<Totals>,
}

/// The rows of one thread: those of functions whose number is `turn` modulo the number of threads.
struct Shard {
    turn: usize,
    turns: usize,
    parts: usize,
    rows: Rows,
    right: Vec<f64>,
}

impl Parts {
    /// The equations of `count` parts, with the weights of observations. `part_of` maps the number of an
    /// observation to its part.
    pub(super) fn unweighed<O: Observations + ?Sized>(
        basis: &Basis,
        observations: &O,
        threads: NonZeroUsize,
        count: usize,
        part_of: impl Fn(u64) -> usize + Sync,
    ) -> Result<Parts> {
        let weigh = |_: u64, observation: &Observation, _: &[(u32, f64)]| Weighed {
            weight: observation.weight,
            residual: None,
        };
        Parts::of(basis, observations, threads, count, part_of, weigh, |_| ())
    }

    /// Number of observations in the domain whose weight is not zero.
    pub(super) fn count(&self) -> u64 {
        self.totals.iter().map(|totals| totals.count).sum()
    }

    /// Like [`Parts::unweighed`], with other weights: `weigh` gets the number of an observation, the
    /// observation and the functions alive there; `see` gets the residuals that `weigh` returns, in order.
    pub(super) fn of<O: Observations + ?Sized>(
        basis: &Basis,
        observations: &O,
        threads: NonZeroUsize,
        count: usize,
        part_of: impl Fn(u64) -> usize + Sync,
        weigh: impl Fn(u64, &Observation, &[(u32, f64)]) -> Weighed + Sync,
        mut see: impl FnMut((f64, u32)),
    ) -> Result<Parts> {
        let turns = threads.get();
        let mut shards: Vec<Shard> =
            (0..turns).map(|turn| Shard::new(turn, turns, count, basis.len())).collect();
        let mut totals = vec![Totals::default(); count];
        let evaluate = |block: Block| Ok(Evaluated::of(basis, block, count, &part_of, &weigh));
        blocks::for_each_round(observations, threads, evaluate, |round| {
            for block in &round {
                totals.iter_mut().zip(&block.totals).for_each(|(all, some)| all.add(some));
                block.residuals.iter().for_each(|&residual| see(residual));
            }
            let add = |shard: &mut Shard| {
                shard.add(&round);
                Ok(())
            };
            parallel::map(threads, &mut shards, add).map(drop)
        })?;
        let rights: Vec<Vec<f64>> = shards.iter_mut().map(|shard| std::mem::take(&mut shard.right)).collect();
        let right = (0..basis.len())
            .flat_map(|function| &rights[function % turns][function / turns * count..][..count])
            .copied()
            .collect();
        let rows = Rows::interleaved(shards.into_iter().map(|shard| shard.rows).collect());
        Ok(Parts { rows, right, totals })
    }

    /// The normal equations of several parts together.
    pub(super) fn sum(&self, is_summed: impl Fn(usize) -> bool) -> NormalEquations {
        let mut totals = Totals::default();
        let chosen = self.totals.iter().enumerate().filter(|&(part, _)| is_summed(part));
        chosen.for_each(|(_, some)| totals.add(some));
        let right = self.right.chunks_exact(self.totals.len()).map(|parts| {
            let chosen = parts.iter().enumerate().filter(|&(part, _)| is_summed(part));
            chosen.map(|(_, value)| value).sum()
        });
        NormalEquations {
            right: right.collect(),
            matrix: Symmetric::of_rows(&self.rows, &is_summed),
            square: totals.square,
            weight: totals.weight,
            count: totals.count,
            outside: totals.outside,
            distance: None,
        }
    }
}

impl Totals {
    fn add(&mut self, other: &Totals) {
        self.square += other.square;
        self.weight += other.weight;
        self.count += other.count;
        self.outside += other.outside;
    }
}

impl Evaluated {
    fn of(
        basis: &Basis,
        block: Block,
        parts: usize,
        part_of: &impl Fn(u64) -> usize,
        weigh: &impl Fn(u64, &Observation, &[(u32, f64)]) -> Weighed,
    ) -> Evaluated {
        let mut evaluated =
            Evaluated { offsets: vec![0], totals: vec![Totals::default(); parts], ..Evaluated::default() };
        let mut scratch = Scratch::default();
        for (index, observation) in block.numbered() {
            let part = part_of(index);
            let totals = &mut evaluated.totals[part];
            if !basis.is_in_domain(observation.point) {
                totals.outside += 1;
                continue;
            }
            let alive = basis.at(observation.point, &mut scratch);
            let Weighed { weight, residual } = weigh(index, observation, alive);
            evaluated.residuals.extend(residual);
            if observation.weight == 0.0 {
                continue;
            }
            // Observations that other weights leave out still have entries, which are zero: so all weights
            // have equations of one pattern.
            totals.count += u64::from(weight > 0.0);
            totals.weight += weight;
            totals.square += weight * observation.value * observation.value;
            evaluated.parts.push(part as u32);
            evaluated.weighted.push([weight, observation.value]);
            evaluated.alive.extend_from_slice(alive);
            evaluated.offsets.push(evaluated.alive.len() as u32);
        }
        evaluated
    }
}

impl Shard {
    fn new(turn: usize, turns: usize, parts: usize, functions: usize) -> Shard {
        let count = (functions + turns - 1 - turn) / turns;
        Shard { turn, turns, parts, rows: Rows::new(count, parts), right: vec![0.0; count * parts] }
    }

    fn add(&mut self, round: &[Evaluated]) {
        for block in round {
            let ranges = block.offsets.windows(2).map(|pair| pair[0] as usize..pair[1] as usize);
            for ((range, &[weight, value]), &part) in ranges.zip(&block.weighted).zip(&block.parts) {
                self.add_one(&block.alive[range], weight, value, part as usize);
            }
        }
    }

    #[inline]
    fn add_one(&mut self, alive: &[(u32, f64)], weight: f64, value: f64, part: usize) {
        for (at, &(function, height)) in alive.iter().enumerate() {
            let function = function as usize;
            if function % self.turns == self.turn {
                let row = function / self.turns;
                self.rows.add(row, part, weight * height, &alive[at..]);
                self.right[row * self.parts + part] += weight * height * value;
            }
        }
    }
}

/// The upper triangle of a symmetric matrix, or of several matrices with entries at the same places, its
/// *parts*.
#[derive(Debug, Clone)]
pub(super) struct Rows {
    parts: usize,
    rows: Vec<Row>,
}

#[derive(Debug, Clone, Default)]
struct Row {
    /// Increasing.
    columns: Vec<u32>,
    /// For each column, the values of all parts.
    values: Vec<f64>,
}

impl Rows {
    pub(super) fn new(count: usize, parts: usize) -> Rows {
        Rows { parts, rows: vec![Row::default(); count] }
    }

    pub(super) fn len(&self) -> usize {
        self.rows.len()
    }

    /// Adds `factor` times the values in `entries`, which are in order of columns, to a row.
    ///
    /// A row has few columns, and consecutive entries are close to each other in it, so a linear walk finds
    /// them.
    #[inline]
    pub(super) fn add(&mut self, row: usize, part: usize, factor: f64, entries: &[(u32, f64)]) {
        let Row { columns, values } = &mut self.rows[row];
        let mut place = 0;
        for &(column, value) in entries {
            while columns.get(place).is_some_and(|&other| other < column) {
                place += 1;
            }
            if columns.get(place) != Some(&column) {
                columns.insert(place, column);
                let at = place * self.parts;
                values.splice(at..at, std::iter::repeat_n(0.0, self.parts));
            }
            values[place * self.parts + part] += factor * value;
        }
    }

    /// The entries of a row: columns with the values of all parts.
    pub(super) fn row(&self, row: usize) -> impl Iterator<Item = (usize, &[f64])> {
        let Row { columns, values } = &self.rows[row];
        columns.iter().map(|&column| column as usize).zip(values.chunks_exact(self.parts))
    }

    /// Merges the rows of several shards: row i is in shard i modulo their number.
    pub(super) fn interleaved(shards: Vec<Rows>) -> Rows {
        let parts = shards.first().map_or(1, |rows| rows.parts);
        let count = shards.iter().map(Rows::len).sum();
        let mut shards: Vec<_> = shards.into_iter().map(|rows| rows.rows.into_iter()).collect();
        let turns = shards.len().max(1);
        let rows = (0..count).filter_map(|row| shards[row % turns].next()).collect();
        Rows { parts, rows }
    }
}

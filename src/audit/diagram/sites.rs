//! The points in each arithmetic; tests run in the cheapest one that can decide them.

use num_bigint::BigInt;

use super::number::{Ball, Number};
use crate::exact::dyadic::Dyadic;
use spmesh_stream::model::cells4::Point4;

/// A geometric test of points relative to one of them.
pub(super) trait Question {
    type Answer;

    /// Whether all numbers in the computation of the answer fit in 127 bits.
    fn fits(&self, extent: Extent) -> bool;

    /// Number of vectors that [`Extent::first`] covers.
    fn first(&self) -> usize;

    /// The result, if the arithmetic can decide it.
    fn answer<T: Number>(&self, vectors: &[[T; 4]]) -> Option<Self::Answer>;
}

/// The largest coordinates of the first vectors of a test and of the others.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent {
    pub(super) first: u64,
    pub(super) rest: u64,
}

/// The points, and the number of tests of them.
///
/// Memory: 32 bytes per point.
pub(super) struct Sites<'a> {
    points: &'a [Point4],
    /// The points times a power of two, if that makes all of them integers below 2^61.
    integers: Option<Vec<[i64; 4]>>,
    /// The power of two that divides all coordinates.
    unit: i32,
    /// Number of tests.
    pub(super) asked: u64,
    /// Tests that needed big integers.
    pub(super) exactly: u64,
}

impl<'a> Sites<'a> {
    /// Domain: all coordinates are finite.
    pub(super) fn new(points: &'a [Point4]) -> Self {
        let nonzero = points.as_flattened().iter().map(|&value| Dyadic::of(value));
        let exponents = nonzero.filter(|value| value.mantissa != 0).map(|value| value.exponent);
        let unit = exponents.min().unwrap_or(0);
        let integers = points.iter().map(|point| small(point, unit)).collect();
        Sites { points, integers, unit, asked: 0, exactly: 0 }
    }

    pub(super) fn at(&self, number: u32) -> Point4 {
        self.points[number as usize]
    }

    /// Runs a test of points relative to the first of them.
    pub(super) fn ask<Q: Question>(&mut self, numbers: &[u32], question: &Q) -> Q::Answer {
        self.asked += 1;
        let Some((&origin, numbers)) = numbers.split_first() else {
            return question.answer::<i128>(&[]).expect("integers tell");
        };
        if let Some(answer) = self.ask_small(origin, numbers, question) {
            return answer;
        }
        let from = self.at(origin);
        let vectors: Vec<[Ball; 4]> = numbers
            .iter()
            .map(|&number| {
                let to = self.at(number);
                [0, 1, 2, 3].map(|i| Ball::difference(to[i], from[i]))
            })
            .collect();
        if let Some(answer) = question.answer(&vectors) {
            return answer;
        }
        self.exactly += 1;
        let from = large(&from, self.unit);
        let vectors: Vec<[BigInt; 4]> = numbers
            .iter()
            .map(|&number| {
                let to = large(&self.at(number), self.unit);
                [0, 1, 2, 3].map(|i| &to[i] - &from[i])
            })
            .collect();
        question.answer(&vectors).expect("integers tell")
    }

    /// The result in 128-bit integers, if they suffice.
    fn ask_small<Q: Question>(&self, origin: u32, numbers: &[u32], question: &Q) -> Option<Q::Answer> {
        let integers = self.integers.as_ref()?;
        let from = integers[origin as usize];
        let vector = |&number: &u32| {
            let to = integers[number as usize];
            [0, 1, 2, 3].map(|i| to[i] - from[i])
        };
        let vectors: Vec<[i64; 4]> = numbers.iter().map(vector).collect();
        let largest = |vectors: &[[i64; 4]]| {
            vectors.as_flattened().iter().map(|value| value.unsigned_abs()).max().unwrap_or(0)
        };
        let (first, rest) = vectors.split_at(question.first());
        if !question.fits(Extent { first: largest(first), rest: largest(rest) }) {
            return None;
        }
        let vectors: Vec<[i128; 4]> = vectors.iter().map(|vector| vector.map(i128::from)).collect();
        Some(question.answer(&vectors).expect("integers tell"))
    }
}

/// The point in units of 2^unit, if that is below 2^61.
fn small(point: &Point4, unit: i32) -> Option<[i64; 4]> {
    let mut integers = [0; 4];
    for (integer, &value) in integers.iter_mut().zip(point) {
        let Dyadic { mantissa, exponent } = Dyadic::of(value);
        if mantissa == 0 {
            continue;
        }
        let shift = exponent - unit;
        if shift + (64 - mantissa.unsigned_abs().leading_zeros() as i32) > 61 {
            return None;
        }
        *integer = mantissa << shift;
    }
    Some(integers)
}

/// The point in units of 2^unit.
fn large(point: &Point4, unit: i32) -> [BigInt; 4] {
    point.map(|value| match Dyadic::of(value) {
        Dyadic { mantissa: 0, .. } => BigInt::ZERO,
        Dyadic { mantissa, exponent } => BigInt::from(mantissa) << (exponent - unit),
    })
}

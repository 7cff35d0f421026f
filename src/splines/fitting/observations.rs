//! Scattered points with values, read as often as a fit needs them.

use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::Point2;

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

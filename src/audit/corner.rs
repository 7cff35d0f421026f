//! Vertices as the geometry sees them, and their box, which the header states.

use super::check::{Check, Ledger, Violation};
use super::vertices::Vertex;
use spmesh_stream::Header;
use spmesh_stream::model::bounds::{Bounds, Point};

/// A vertex in D dimensions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Corner<const D: usize> {
    pub(super) id: u64,
    pub(super) at: [f64; D],
    /// 0 without weights.
    pub(super) weight: f64,
}

impl<const D: usize> Corner<D> {
    pub(super) fn of<S>(vertex: &Vertex<S>) -> Self {
        let Vertex { id, at, weight, .. } = *vertex;
        Corner { id, at: std::array::from_fn(|axis| at[axis]), weight }
    }

    /// A vertex without a weight.
    pub(super) fn new(id: u64, at: [f64; D]) -> Self {
        Corner { id, at, weight: 0.0 }
    }

    /// Position and weight.
    pub(super) fn weighted(self) -> ([f64; D], f64) {
        (self.at, self.weight)
    }

    /// The position as a point for messages.
    fn point(self) -> Point {
        std::array::from_fn(|axis| self.at.get(axis).copied().unwrap_or(0.0))
    }
}

/// Adds the corners to the points of a violation.
pub(super) fn name_corners<const D: usize>(violation: Violation, corners: &[Corner<D>]) -> Violation {
    corners.iter().fold(violation, |violation, corner| violation.with(corner.id, corner.point()))
}

/// The ids, as they are written in messages.
pub(super) fn named<const D: usize>(corners: &[Corner<D>]) -> String {
    let ids: Vec<String> = corners.iter().map(|corner| corner.id.to_string()).collect();
    format!("({})", ids.join(", "))
}

/// The box that a header states and the box of the points so far.
#[derive(Debug)]
pub(super) struct Extent {
    stated: Option<Bounds>,
    found: Option<Bounds>,
}

impl Extent {
    pub(super) fn new(header: &Header) -> Self {
        Extent { stated: header.bounds, found: None }
    }

    pub(super) fn add(&mut self, point: Point) {
        match &mut self.found {
            Some(found) => found.extend(point),
            None => self.found = Some(Bounds::of_point(point)),
        }
    }

    /// Proves that the stated box, if there is one, holds the points. It may be larger than theirs.
    pub(super) fn check_holds(&self, ledger: &mut Ledger) -> Result<(), Violation> {
        let (Some(stated), Some(found)) = (self.stated, self.found) else { return Ok(()) };
        ledger.add(Check::Bounds, 1);
        if stated.contains(found.min) && stated.contains(found.max) {
            return Ok(());
        }
        let message = format!(
            "the header states {:?} to {:?} (stored coordinates), but the points span {:?} to {:?}",
            stated.min, stated.max, found.min, found.max
        );
        Err(Violation::new(Check::Bounds, message))
    }
}

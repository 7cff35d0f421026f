//! Checks that the bounding box of the header holds the points.

use super::check::{Check, Ledger, Violation};
use spmesh_stream::Header;
use spmesh_stream::model::bounds::{Bounds, Point};

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

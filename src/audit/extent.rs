//! Whether the bounding box of the header is that of the points.

use super::check::{Check, Ledger, Violation};
use crate::bounds::{Bounds, Point};
use crate::stream::Header;

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

    /// Proves that the two boxes are equal on the first `axes` axes. Nothing is claimed without a stated box.
    ///
    /// On meshes with merged points the third axis is not claimed: the elevation that set the box may be one
    /// that the policy for duplicates dropped.
    pub(super) fn check_tight(&self, axes: usize, ledger: &mut Ledger) -> Result<(), Violation> {
        let Some(stated) = self.stated else { return Ok(()) };
        let Some(found) = self.found else {
            return Err(Violation::new(Check::Bounds, "the header states a bounding box of no points"));
        };
        for axis in 0..axes {
            ledger.add(Check::Bounds, 2);
            if (stated.min[axis], stated.max[axis]) != (found.min[axis], found.max[axis]) {
                let message = format!(
                    "the header states {} from {} to {} (stored coordinates), but the points span {} to {}",
                    ["x", "y", "z"][axis],
                    stated.min[axis],
                    stated.max[axis],
                    found.min[axis],
                    found.max[axis]
                );
                return Err(Violation::new(Check::Bounds, message));
            }
        }
        Ok(())
    }
}

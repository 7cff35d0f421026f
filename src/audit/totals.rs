//! Checks that END accounts for all points of the input.

use super::check::{Check, Ledger, Violation};
use spmesh_stream::Totals;

/// Proves that the vertices of a whole mesh and the points merged into them are all points.
pub(super) fn check_points(vertices: u64, totals: &Totals, ledger: &mut Ledger) -> Result<(), Violation> {
    ledger.add(Check::Counts, 1);
    if vertices.checked_add(totals.merged) == Some(totals.points) {
        return Ok(());
    }
    let message = format!(
        "{vertices} vertices and {} merged points are not the {} points of the input",
        totals.merged, totals.points
    );
    Err(Violation::new(Check::Counts, message))
}

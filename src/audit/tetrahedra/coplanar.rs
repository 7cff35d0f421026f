//! Vertices that need no tetrahedra: all in a plane.

use std::cmp::Ordering;

use super::facets::{Corner, name_corners};
use super::live::named;
use crate::audit::check::{Check, Ledger, Violation};
use crate::audit::exact::space::{are_collinear, lexicographic, orientation};

/// Proves that vertices which no tetrahedron uses need none: they are all distinct and lie in a plane.
pub(super) fn check_plane(vertices: &mut [Corner], ledger: &mut Ledger) -> Result<(), Violation> {
    vertices.sort_by(|p, q| lexicographic(p.at, q.at).then(p.id.cmp(&q.id)));
    for pair in vertices.windows(2) {
        ledger.add(Check::Vertices, 1);
        if pair[0].at == pair[1].at {
            let message = format!("vertices {} and {} coincide", pair[0].id, pair[1].id);
            return Err(name_corners(Violation::new(Check::Vertices, message), pair));
        }
    }
    let [first, between @ .., last] = &vertices[..] else { return Ok(()) };
    let Some(third) = between.iter().find(|corner| !are_collinear(first.at, corner.at, last.at)) else {
        return Ok(());
    };
    for corner in between {
        let turn = orientation(first.at, third.at, last.at, corner.at);
        ledger.count(Check::Hull, turn.exactly);
        if turn.sign != Ordering::Equal {
            let four = [*first, *third, *last, *corner];
            let message =
                format!("there are no tetrahedra, but vertices {} do not lie in a plane", named(&four));
            return Err(name_corners(Violation::new(Check::Hull, message), &four));
        }
    }
    Ok(())
}

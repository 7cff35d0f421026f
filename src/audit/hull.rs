//! The boundary of a whole triangulation: one convex cycle, or vertices on a line.

use std::cmp::Ordering;
use std::collections::HashMap;

use foldhash::fast::RandomState;

use super::check::{Check, Ledger, Violation};
use super::edges::{Corner, OpenEdges};
use super::exact::plane::{Xy, lexicographic, orientation};

/// Corners of the boundary.
///
/// Memory: the hull, collinear vertices included. Without triangles all vertices lie on it.
#[derive(Debug, Default)]
pub(super) struct Hull {
    corners: HashMap<u64, Xy, RandomState>,
}

impl Hull {
    /// Adds a finalized vertex with one open edge in and one out.
    pub(super) fn add(&mut self, id: u64, at: Xy) {
        self.corners.insert(id, at);
    }

    /// Proves that the open edges are one cycle around a convex polygon; all their ends must have been added.
    ///
    /// A cycle that never turns right and never turns back turns by less than half a circle at each corner.
    /// So it cannot jump over the lexicographically increasing directions, which are a half-open half circle,
    /// and goes around as often as it changes from increasing to decreasing.
    pub(super) fn check(&self, edges: &OpenEdges, ledger: &mut Ledger) -> Result<(), Violation> {
        let next: HashMap<u64, u64, RandomState> = edges.iter().map(|[from, to]| (from, to)).collect();
        let Some(start) = self.first() else {
            return Err(Violation::new(Check::Hull, "the triangles have no boundary"));
        };
        let (mut before, mut here) = (start, self.corner(next[&start.id]));
        let (mut steps, mut peaks) = (0, 0);
        loop {
            let after = self.corner(next[&here.id]);
            peaks += u64::from(self.turn(before, here, after, ledger)?);
            (before, here) = (here, after);
            steps += 1;
            if before.id == start.id {
                break;
            }
        }
        if steps < next.len() {
            return Err(self.second_cycle(edges, &next, start));
        }
        if peaks != 1 {
            let message = format!("the boundary goes around {peaks} times, expected once");
            return Err(name_corner(Violation::new(Check::Hull, message), start));
        }
        Ok(())
    }

    /// Checks the corner `here` of the boundary; whether it is a maximum of the lexicographic order.
    fn turn(
        &self,
        before: Corner,
        here: Corner,
        after: Corner,
        ledger: &mut Ledger,
    ) -> Result<bool, Violation> {
        let turn = orientation(before.at, here.at, after.at);
        ledger.count(Check::Hull, turn.exactly);
        let (arrives, leaves) = (lexicographic(before.at, here.at), lexicographic(here.at, after.at));
        let fault = match turn.sign {
            Ordering::Greater => None,
            Ordering::Less => Some("is concave"),
            Ordering::Equal => (arrives != leaves).then_some("turns back"),
        };
        if let Some(fault) = fault {
            let message = format!("the boundary from {} over {} to {} {fault}", before.id, here.id, after.id);
            let violation = Violation::new(Check::Hull, message);
            return Err([before, here, after].into_iter().fold(violation, name_corner));
        }
        Ok(arrives == Ordering::Less && leaves == Ordering::Greater)
    }

    /// Names an edge of the boundary that is not on the cycle through `start`.
    fn second_cycle(
        &self,
        edges: &OpenEdges,
        next: &HashMap<u64, u64, RandomState>,
        start: Corner,
    ) -> Violation {
        let mut rest = next.clone();
        let mut at = start.id;
        while let Some(after) = rest.remove(&at) {
            at = after;
        }
        let [from, to] =
            edges.iter().filter(|[from, _]| rest.contains_key(from)).min().expect("the cycle is not all");
        let message = format!(
            "the boundary is more than one cycle: edge {from} to {to} is open and not on the cycle of {}",
            start.id
        );
        let violation = Violation::new(Check::Hull, message);
        [self.corner(from), self.corner(to)].into_iter().fold(violation, name_corner)
    }

    /// The lexicographically smallest corner, of those the one with the smallest id.
    fn first(&self) -> Option<Corner> {
        let corners = self.corners.iter().map(|(&id, &at)| Corner { id, at });
        corners.min_by(|p, q| lexicographic(p.at, q.at).then(p.id.cmp(&q.id)))
    }

    fn corner(&self, id: u64) -> Corner {
        Corner { id, at: self.corners[&id] }
    }
}

/// Proves that vertices which no triangle uses need none: they are all distinct and lie on a line.
pub(super) fn check_line(vertices: &mut [Corner], ledger: &mut Ledger) -> Result<(), Violation> {
    vertices.sort_by(|p, q| lexicographic(p.at, q.at).then(p.id.cmp(&q.id)));
    for pair in vertices.windows(2) {
        ledger.add(Check::Vertices, 1);
        if pair[0].at == pair[1].at {
            let message = format!("vertices {} and {} coincide", pair[0].id, pair[1].id);
            let violation = Violation::new(Check::Vertices, message);
            return Err(pair.iter().copied().fold(violation, name_corner));
        }
    }
    let [first, between @ .., last] = &vertices[..] else { return Ok(()) };
    for corner in between {
        let turn = orientation(first.at, corner.at, last.at);
        ledger.count(Check::Hull, turn.exactly);
        if turn.sign != Ordering::Equal {
            let message = format!(
                "there are no triangles, but vertices {}, {} and {} do not lie on a line",
                first.id, corner.id, last.id
            );
            let violation = Violation::new(Check::Hull, message);
            return Err([*first, *corner, *last].into_iter().fold(violation, name_corner));
        }
    }
    Ok(())
}

fn name_corner(violation: Violation, corner: Corner) -> Violation {
    violation.with(corner.id, corner.point())
}

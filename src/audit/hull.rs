//! The boundary of a whole triangulation: one convex cycle.

use std::cmp::Ordering;
use std::collections::HashMap;

use foldhash::fast::RandomState;

use super::check::{Check, Ledger, Violation};
use super::corner::name_corners;
use super::exact::plane::{Xy, lexicographic, orientation};
use super::triangles::{Corner, OpenEdges};

/// A convex polygon, for tests of points.
#[derive(Debug)]
pub(super) struct Outline {
    /// The corners from the first to the last in lexicographic order, along the lower side and the upper one.
    lower: Vec<Xy>,
    upper: Vec<Xy>,
}

impl Outline {
    /// Whether a point is outside. Cost: the polygon.
    pub(super) fn excludes(&self, point: Xy, ledger: &mut Ledger) -> bool {
        let is_beyond =
            |pair: &[Xy], outside, ledger: &mut Ledger| turn(pair[0], pair[1], point, ledger) == outside;
        self.sides().any(|(chain, outside)| chain.windows(2).any(|pair| is_beyond(pair, outside, ledger)))
    }

    /// Both chains, from left to right, and the side of their edges that is outside.
    fn sides(&self) -> impl Iterator<Item = (&[Xy], Ordering)> {
        [(&self.lower[..], Ordering::Less), (&self.upper[..], Ordering::Greater)].into_iter()
    }
}

fn turn(p: Xy, q: Xy, r: Xy, ledger: &mut Ledger) -> Ordering {
    let turn = orientation(p, q, r);
    ledger.count(Check::Constraints, turn.exactly);
    turn.sign
}

/// Corners of the boundary.
///
/// Memory: the hull, collinear vertices included.
#[derive(Debug, Default)]
pub(super) struct Hull {
    corners: HashMap<u64, Xy, RandomState>,
}

impl Hull {
    /// Adds a finalized vertex with one open edge in and one out.
    pub(super) fn add(&mut self, corner: Corner) {
        self.corners.insert(corner.id, corner.at);
    }

    /// Proves that the open edges are one cycle around a convex polygon; all their ends must have been added.
    ///
    /// A cycle that never turns right and never turns back turns by less than half a circle at each corner.
    /// So it cannot jump over the lexicographically increasing directions, which are a half-open half circle,
    /// and goes around as often as it changes from increasing to decreasing.
    pub(super) fn check(&self, edges: &OpenEdges, ledger: &mut Ledger) -> Result<(), Violation> {
        let next: HashMap<u64, u64, RandomState> = edges.iter().map(|([from, to], _)| (from, to)).collect();
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
            return Err(name_corners(Violation::new(Check::Hull, message), &[start]));
        }
        Ok(())
    }

    /// The polygon of a boundary that passed [`Hull::check`].
    pub(super) fn outline(&self, edges: &OpenEdges) -> Outline {
        let next: HashMap<u64, u64, RandomState> = edges.iter().map(|([from, to], _)| (from, to)).collect();
        let start = self.first().expect("the boundary was checked");
        let mut cycle = vec![start.at];
        let mut here = next[&start.id];
        while here != start.id {
            cycle.push(self.corners[&here]);
            here = next[&here];
        }
        let peak = cycle.windows(2).position(|pair| lexicographic(pair[0], pair[1]) == Ordering::Greater);
        let peak = peak.unwrap_or(cycle.len() - 1);
        let lower = cycle[..=peak].to_vec();
        let upper = std::iter::once(start.at).chain(cycle[peak..].iter().rev().copied()).collect();
        Outline { lower, upper }
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
            return Err(name_corners(Violation::new(Check::Hull, message), &[before, here, after]));
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
        let others = edges.iter().map(|(ends, _)| ends).filter(|[from, _]| rest.contains_key(from));
        let [from, to] = others.min().expect("the cycle is not all");
        let message = format!(
            "the boundary is more than one cycle: edge {from} to {to} is open and not on the cycle of {}",
            start.id
        );
        name_corners(Violation::new(Check::Hull, message), &[self.corner(from), self.corner(to)])
    }

    /// The lexicographically smallest corner, of those the one with the smallest id.
    fn first(&self) -> Option<Corner> {
        let corners = self.corners.iter().map(|(&id, &at)| Corner::new(id, at));
        corners.min_by(|p, q| lexicographic(p.at, q.at).then(p.id.cmp(&q.id)))
    }

    /// A vertex of the boundary.
    pub(super) fn corner(&self, id: u64) -> Corner {
        Corner::new(id, self.corners[&id])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cycle over the triangle that is walked `times` times.
    fn walk(times: usize) -> Result<(), Violation> {
        let triangle = [[10.0, -6.0], [0.0, 11.0], [-10.0, -6.0]];
        let (mut hull, mut edges) = (Hull::default(), OpenEdges::new());
        let corners: Vec<Corner> = (0..3 * times).map(|i| Corner::new(i as u64, triangle[i % 3])).collect();
        for (i, &corner) in corners.iter().enumerate() {
            hull.add(corner);
            edges.meet([corner.id, corners[(i + 1) % corners.len()].id], corner);
        }
        hull.check(&edges, &mut Ledger::default())
    }

    #[test]
    fn a_boundary_goes_around_once() {
        walk(1).unwrap();
        for times in 2..5 {
            let violation = walk(times).unwrap_err();
            assert!(violation.message.contains(&format!("goes around {times} times")), "{violation:?}");
        }
    }
}

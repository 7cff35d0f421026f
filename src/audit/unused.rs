//! Vertices that no simplex uses: legal while there are no simplices at all.

use std::cmp::Ordering;

use super::check::{Check, Ledger, Violation};
use super::corner::{Corner, name_corners, named};
use super::exact::plane;
use super::exact::space::{are_collinear, orientation};

/// Vertices that were finalized without a simplex.
///
/// Memory: these vertices. If there are simplices, the first such vertex is a violation.
#[derive(Debug, Default)]
pub(super) struct Unused<const D: usize> {
    corners: Vec<Corner<D>>,
}

impl<const D: usize> Unused<D> {
    pub(super) fn add(&mut self, corner: Corner<D>) {
        self.corners.push(corner);
    }

    /// Removes all of them.
    pub(super) fn drain(&mut self) -> impl Iterator<Item = Corner<D>> {
        self.corners.drain(..)
    }

    /// Number of vertices.
    pub(super) fn len(&self) -> u64 {
        self.corners.len() as u64
    }

    /// Proves that there are none, as required of a mesh with simplices. `simplex` names these in the
    /// message.
    pub(super) fn check_none(&self, simplex: &str) -> Result<(), Violation> {
        let Some(corner) = self.corners.first() else { return Ok(()) };
        let message = format!("no {simplex} uses vertex {}", corner.id);
        Err(name_corners(Violation::new(Check::Vertices, message), &[*corner]))
    }

    /// Puts the vertices in lexicographic order and proves that they are distinct.
    fn check_distinct(&mut self, ledger: &mut Ledger) -> Result<(), Violation> {
        let lexicographic = |p: &Corner<D>, q: &Corner<D>| {
            p.at.partial_cmp(&q.at).expect("coordinates are finite").then(p.id.cmp(&q.id))
        };
        self.corners.sort_by(lexicographic);
        for pair in self.corners.windows(2) {
            ledger.add(Check::Vertices, 1);
            if pair[0].at == pair[1].at {
                let message = format!("vertices {} and {} coincide", pair[0].id, pair[1].id);
                return Err(name_corners(Violation::new(Check::Vertices, message), pair));
            }
        }
        Ok(())
    }
}

impl Unused<2> {
    /// Proves that the vertices need no triangles: they are all distinct and lie on a line.
    pub(super) fn check_line(&mut self, ledger: &mut Ledger) -> Result<(), Violation> {
        self.check_distinct(ledger)?;
        let [first, between @ .., last] = &self.corners[..] else { return Ok(()) };
        for corner in between {
            let turn = plane::orientation(first.at, corner.at, last.at);
            ledger.count(Check::Hull, turn.exactly);
            if turn.sign != Ordering::Equal {
                let message = format!(
                    "there are no triangles, but vertices {}, {} and {} do not lie on a line",
                    first.id, corner.id, last.id
                );
                return Err(name_corners(Violation::new(Check::Hull, message), &[*first, *corner, *last]));
            }
        }
        Ok(())
    }
}

impl Unused<3> {
    /// Proves that the vertices need no tetrahedra: they are all distinct and lie in a plane.
    pub(super) fn check_plane(&mut self, ledger: &mut Ledger) -> Result<(), Violation> {
        self.check_distinct(ledger)?;
        let [first, between @ .., last] = &self.corners[..] else { return Ok(()) };
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
}

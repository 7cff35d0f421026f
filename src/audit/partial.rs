//! Audit of the final triangles of a region and its residual.
//!
//! It proves what another program needs to finish the mesh: the triangles are correct as far as they go, the
//! walls and the residual are all that is open, and nothing of the region is lost or outside of it. Whether
//! the rest fits is proved when the merged mesh is audited.

use std::collections::HashSet;

use foldhash::fast::RandomState;

use super::check::{Check, Ledger, Violation};
use super::exact::plane::lexicographic;
use super::triangles::{Fans, Standard, Triangles};
use super::vertices::Vertex;
use crate::bounds::{Point, Region};
use crate::stream::{Header, Patch, Totals};

/// State of the audit of a partial mesh. Memory: the width of the stream and the residual.
pub(super) struct PartialAudit {
    region: Region,
    triangles: Triangles,
    residual: Vec<(Option<u64>, Point)>,
    walls: Vec<[u32; 2]>,
}

/// Checks that a partial mesh must pass, in any case.
pub(super) const PARTIAL_CHECKS: [Check; 9] = [
    Check::Orientation,
    Check::Edges,
    Check::Delaunay,
    Check::Vertices,
    Check::Finalization,
    Check::Counts,
    Check::Region,
    Check::Residual,
    Check::Walls,
];

impl PartialAudit {
    pub(super) fn new(header: &Header, standard: Standard) -> Self {
        PartialAudit {
            region: header.region.unwrap_or(Region::PLANE),
            triangles: Triangles::new(standard),
            residual: Vec::new(),
            walls: Vec::new(),
        }
    }

    pub(super) fn patch(&mut self, patch: &Patch, ledger: &mut Ledger) -> Result<(), Violation> {
        for (&at, id) in patch.new.iter().zip(patch.first_id..) {
            self.check_region(Some(id), at, ledger)?;
        }
        self.triangles.patch(patch, ledger, finalize)
    }

    pub(super) fn residual_points(
        &mut self,
        points: &[(Option<u64>, Point)],
        ledger: &mut Ledger,
    ) -> Result<(), Violation> {
        for &(id, at) in points {
            self.check_region(id, at, ledger)?;
        }
        self.residual.extend_from_slice(points);
        Ok(())
    }

    pub(super) fn walls(&mut self, walls: &[[u32; 2]]) {
        self.walls.extend_from_slice(walls);
    }

    pub(super) fn end(&mut self, totals: &Totals, ledger: &mut Ledger) -> Result<(), Violation> {
        self.check_written(ledger)?;
        self.check_distinct(ledger)?;
        self.check_walls(ledger)?;
        let unwritten = self.residual.iter().filter(|(id, _)| id.is_none()).count() as u64;
        ledger.add(Check::Counts, 1);
        if (self.triangles.vertices.seen() + unwritten).checked_add(totals.merged) != Some(totals.points) {
            let message = format!(
                "{} vertices, {unwritten} residual points that are none and {} merged points are not the {} points",
                self.triangles.vertices.seen(),
                totals.merged,
                totals.points
            );
            return Err(Violation::new(Check::Counts, message));
        }
        Ok(())
    }

    pub(super) fn triangles(&self) -> &Triangles {
        &self.triangles
    }

    fn check_region(&self, id: Option<u64>, at: Point, ledger: &mut Ledger) -> Result<(), Violation> {
        ledger.add(Check::Region, 1);
        if self.region.contains(at) {
            return Ok(());
        }
        let message = format!("a point lies outside of the region {:?}", self.region);
        Err(Violation::new(Check::Region, message).with(id, at))
    }

    /// The residual points with an id are the live vertices, each once and where the vertex is.
    fn check_written(&self, ledger: &mut Ledger) -> Result<(), Violation> {
        let fail = |message: String| Violation::new(Check::Residual, message);
        let mut seen: HashSet<u64, RandomState> = HashSet::default();
        for &(id, at) in &self.residual {
            let Some(id) = id else { continue };
            ledger.add(Check::Residual, 1);
            let Some(vertex) = self.triangles.vertices.live(id) else {
                return Err(fail(format!("vertex {id} of the residual was finalized")).with(id, at));
            };
            if vertex.at != at {
                let violation = fail(format!("vertex {id} of the residual lies elsewhere in its patch"));
                return Err(violation.with(id, at).with(id, vertex.at));
            }
            if !seen.insert(id) {
                return Err(fail(format!("vertex {id} is in the residual twice")).with(id, at));
            }
        }
        match self.triangles.vertices.first_live(|vertex| !seen.contains(&vertex.id)) {
            None => Ok(()),
            Some(lost) => {
                let message = format!("vertex {} is neither finalized nor in the residual", lost.id);
                Err(fail(message).with(lost.id, lost.at))
            }
        }
    }

    /// No two residual points have the same x and y.
    fn check_distinct(&self, ledger: &mut Ledger) -> Result<(), Violation> {
        let mut sorted = self.residual.clone();
        sorted.sort_by(|(p, at_p), (q, at_q)| {
            lexicographic([at_p[0], at_p[1]], [at_q[0], at_q[1]]).then(p.cmp(q))
        });
        ledger.add(Check::Residual, sorted.len().saturating_sub(1) as u64);
        match sorted.windows(2).find(|pair| pair[0].1[..2] == pair[1].1[..2]) {
            None => Ok(()),
            Some(pair) => {
                let violation = Violation::new(Check::Residual, "two residual points coincide");
                Err(pair.iter().fold(violation, |violation, &(id, at)| violation.with(id, at)))
            }
        }
    }

    /// Every wall is an open edge, and every open edge has a wall: a final triangle lies to the left of both.
    fn check_walls(&mut self, ledger: &mut Ledger) -> Result<(), Violation> {
        for &[from, to] in &self.walls {
            ledger.add(Check::Walls, 1);
            let ends = [from, to].map(|end| self.residual[end as usize]);
            let is_open = match ends.map(|(id, _)| id) {
                [Some(from), Some(to)] => self.triangles.edges.close([from, to]),
                _ => false,
            };
            if !is_open {
                let message = format!(
                    "the wall from residual point {from} to {to} is no open edge of a final triangle on its left"
                );
                let violation = Violation::new(Check::Walls, message);
                return Err(ends.iter().fold(violation, |violation, &(id, at)| violation.with(id, at)));
            }
        }
        match self.triangles.edges.iter().map(|(ends, _)| ends).min() {
            None => Ok(()),
            Some(ends) => {
                let message = format!("the open edge {} to {} has no wall", ends[0], ends[1]);
                let live = ends.iter().filter_map(|&end| self.triangles.vertices.live(end));
                let violation = Violation::new(Check::Walls, message);
                Err(live.fold(violation, |violation, vertex| violation.with(vertex.id, vertex.at)))
            }
        }
    }
}

/// A final vertex is closed on all sides: an open edge would be a wall, whose ends are in the residual.
fn finalize(vertex: &Vertex<Fans>, ledger: &mut Ledger) -> Result<(), Violation> {
    ledger.add(Check::Vertices, 1);
    let fans = vertex.star;
    let fault = if !fans.is_used {
        "without a triangle"
    } else if fans.entering + fans.leaving > 0 {
        "with open edges"
    } else {
        return fans.winding.check_once(vertex);
    };
    let message = format!("vertex {} is finalized {fault}", vertex.id);
    Err(Violation::new(Check::Vertices, message).with(vertex.id, vertex.at))
}

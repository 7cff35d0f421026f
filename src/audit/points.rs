//! Audit of a points stream: what the tags, the chunks, the header and END promise.

use super::cells::{CodeSet, code_of, codes_of};
use super::check::{Check, Ledger, Violation};
use super::corner::Extent;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::cells::{CellCode, CellTree};
use spmesh_stream::{Header, Totals};

/// State of the audit of a points stream. Memory: the border of the tagged part, in cells.
pub(super) struct PointsAudit {
    tree: Option<CellTree>,
    chunked: bool,
    extent: Extent,
    points: u64,
    tagged: CodeSet,
    /// Smallest and largest code of the points that wait for the tag of their cell. A cell is a range of
    /// codes, so that all of them lie in it if these two do.
    waiting: Option<[u64; 2]>,
    /// Whether tags came after the last point.
    in_tags: bool,
}

/// Checks that a points stream must pass.
pub(super) fn points_checks(header: &Header) -> Vec<Check> {
    let mut checks = vec![Check::Counts, Check::Bounds];
    if header.tree.is_some() {
        checks.extend([Check::Region, Check::Cells]);
    }
    if header.chunked {
        checks.push(Check::Chunks);
    }
    checks
}

impl PointsAudit {
    pub(super) fn new(header: &Header) -> Self {
        PointsAudit {
            tree: header.tree,
            chunked: header.chunked,
            extent: Extent::new(header),
            points: 0,
            tagged: CodeSet::default(),
            waiting: None,
            in_tags: false,
        }
    }

    pub(super) fn points(&mut self, points: &[Point], ledger: &mut Ledger) -> Result<(), Violation> {
        self.points += points.len() as u64;
        points.iter().for_each(|&point| self.extent.add(point));
        match self.tree {
            None => Ok(()),
            Some(tree) => points.iter().try_for_each(|&point| self.point(&tree, point, ledger)),
        }
    }

    fn point(&mut self, tree: &CellTree, point: Point, ledger: &mut Ledger) -> Result<(), Violation> {
        ledger.add(Check::Region, 1);
        let Some(code) = code_of(tree, point) else {
            let message = "a point lies outside of the cube of the finalization tree";
            return Err(Violation::new(Check::Region, message).with(None, point));
        };
        if !self.tagged.is_empty() {
            ledger.add(Check::Cells, 1);
            if self.tagged.contains(code) {
                let message = "a point follows the tag of its cell";
                return Err(Violation::new(Check::Cells, message).with(None, point));
            }
        }
        if std::mem::take(&mut self.in_tags) {
            self.check_chunk()?;
        }
        let [first, last] = self.waiting.unwrap_or([code, code]);
        self.waiting = Some([first.min(code), last.max(code)]);
        Ok(())
    }

    pub(super) fn cells(&mut self, cells: &[CellCode], ledger: &mut Ledger) -> Result<(), Violation> {
        let Some(tree) = self.tree else { return Ok(()) };
        for &cell in cells {
            self.in_tags = true;
            ledger.add(Check::Cells, 1);
            let codes = codes_of(&tree, cell);
            if self.tagged.covers(codes.clone()) {
                let message = format!("cell {} is tagged, but all of it is final already", cell.0);
                return Err(Violation::new(Check::Cells, message));
            }
            if self.waiting.is_some_and(|waiting| waiting.iter().all(|code| codes.contains(code))) {
                self.waiting = None;
                if self.chunked {
                    ledger.add(Check::Chunks, 1);
                }
            }
            self.tagged.insert(codes);
        }
        Ok(())
    }

    /// All points before the last tags must have found the tag of the cell that holds all of them.
    fn check_chunk(&mut self) -> Result<(), Violation> {
        if self.waiting.take().is_none() || !self.chunked {
            return Ok(());
        }
        let message =
            "the points before the last tags do not lie in one cell, the same for all, that is tagged";
        Err(Violation::new(Check::Chunks, message))
    }

    pub(super) fn end(&mut self, totals: &Totals, ledger: &mut Ledger) -> Result<(), Violation> {
        ledger.add(Check::Counts, 1);
        if totals.points != self.points {
            let message = format!("END states {} points, found {}", totals.points, self.points);
            return Err(Violation::new(Check::Counts, message));
        }
        self.check_chunk()?;
        self.extent.check_holds(ledger)
    }
}

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

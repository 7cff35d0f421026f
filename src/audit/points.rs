//! Audit of a points stream: what the tags, the chunks and the header promise.

use super::cells::{CodeSet, code_of, codes_of};
use super::check::{Check, Ledger, Violation};
use super::extent::Extent;
use crate::bounds::Point;
use crate::cells::{CellCode, CellTree};
use crate::stream::{Header, Totals};

/// State of the audit of a points stream. Memory: the border of the tagged part, in cells.
pub(super) struct PointsAudit {
    tree: Option<CellTree>,
    chunked: bool,
    extent: Extent,
    points: u64,
    /// Everything that is tagged, and the tagged cells that hold points.
    tagged: CodeSet,
    occupied: CodeSet,
    /// Smallest and largest code of the points since the last tag. A cell is a range of codes, so that all
    /// of them lie in it if these two do.
    run: Option<[u64; 2]>,
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
            occupied: CodeSet::default(),
            run: None,
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
        let [first, last] = self.run.unwrap_or([code, code]);
        self.run = Some([first.min(code), last.max(code)]);
        Ok(())
    }

    pub(super) fn cells(&mut self, cells: &[CellCode], ledger: &mut Ledger) -> Result<(), Violation> {
        let Some(tree) = self.tree else { return Ok(()) };
        if let Some(run) = self.run.take()
            && self.chunked
        {
            self.chunk(&tree, run, cells, ledger)?;
        }
        cells.iter().for_each(|&cell| self.tagged.insert(codes_of(&tree, cell)));
        Ok(())
    }

    /// The points since the last tag must be all those of one of the cells that are tagged now.
    fn chunk(
        &mut self,
        tree: &CellTree,
        run: [u64; 2],
        cells: &[CellCode],
        ledger: &mut Ledger,
    ) -> Result<(), Violation> {
        ledger.add(Check::Chunks, 1);
        let holds = |cell: &&CellCode| run.iter().all(|code| codes_of(tree, **cell).contains(code));
        let Some(cell) = cells.iter().find(holds) else {
            let cell = cells.first().map_or(0, |cell| cell.0);
            let message = format!("points before the tag of cell {cell} do not all lie in one tagged cell");
            return Err(Violation::new(Check::Chunks, message));
        };
        let codes = codes_of(tree, *cell);
        if self.occupied.overlaps(codes.clone()) {
            let message = format!("points of cell {} stand in several places of the stream", cell.0);
            return Err(Violation::new(Check::Chunks, message));
        }
        self.occupied.insert(codes);
        Ok(())
    }

    pub(super) fn end(&mut self, totals: &Totals, ledger: &mut Ledger) -> Result<(), Violation> {
        ledger.add(Check::Counts, 1);
        if totals.points != self.points {
            let message = format!("END states {} points, found {}", totals.points, self.points);
            return Err(Violation::new(Check::Counts, message));
        }
        if self.chunked && self.run.is_some() {
            let message = "the last points of a chunked stream lie in no tagged cell";
            return Err(Violation::new(Check::Chunks, message));
        }
        self.extent.check_tight(3, ledger)
    }
}

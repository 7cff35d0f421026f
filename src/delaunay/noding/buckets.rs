//! Segments and places by the cells of a grid, each with few of them: where the division of the plane starts.

use super::exact::Place;
use super::search::Cell;
use crate::cell_lists::CellLists;
use crate::cell_walk::{TOLERANCE, for_each_cell_within};

/// Segments of a cell, on average over all cells.
const PER_CELL: f64 = 6.0;

/// Entries of segments in cells for each segment, at most: with more, cells are larger.
const ENTRIES_MAX: usize = 4;

/// A segment is listed in all cells that places are in within so many pixels of it: more than half of a
/// pixel, for the sides of cells, and all rounding errors.
const REACH: f64 = 1.5;

/// Cells of a grid and what is in them, column by column.
pub(super) struct Buckets {
    whole: Cell,
    /// Pixels on a side of a cell.
    side: i64,
    /// Numbers of columns and rows.
    counts: [usize; 2],
    segments: CellLists,
    places: CellLists,
}

impl Buckets {
    /// `ends` are the places of the ends of segments. Memory: about 12 bytes per segment, at most 24.
    pub(super) fn of(places: &[Place], ends: &[[u32; 2]]) -> Buckets {
        let whole = Cell::around(places);
        let target = (ends.len() as f64 / PER_CELL).max(1.0);
        let lens = [whole.len(0) as f64, whole.len(1) as f64];
        // A long thin box has at most as many cells along as it should have in all.
        let side = (lens[0] * lens[1] / target).sqrt().max(lens[0] / target).max(lens[1] / target);
        let mut side = side.ceil().max(1.0) as i64;
        loop {
            let counts = [0, 1].map(|axis| (whole.len(axis) as usize).div_ceil(side as usize));
            let cells = Buckets { whole, side, counts, ..Buckets::empty() };
            // If there is one cell, it has one entry for each segment.
            let Some(segments) = cells.lists_of_segments(places, ends) else {
                side *= 2;
                continue;
            };
            let of_places = CellLists::of(cells.len(), places.len() as u32, usize::MAX, |number, visit| {
                visit(cells.cell_of(places[number as usize]));
            });
            return Buckets { segments, places: of_places.expect("an entry for each place"), ..cells };
        }
    }

    fn empty() -> Buckets {
        let whole = Cell::around(&[]);
        let (segments, places) = (CellLists::default(), CellLists::default());
        Buckets { whole, side: 1, counts: [1; 2], segments, places }
    }

    fn len(&self) -> usize {
        self.counts[0] * self.counts[1]
    }

    /// `None` if there are too many entries.
    fn lists_of_segments(&self, places: &[Place], ends: &[[u32; 2]]) -> Option<CellLists> {
        let side = self.side as f64;
        let most = ENTRIES_MAX * ends.len() + 1;
        CellLists::of(self.len(), ends.len() as u32, most, |number, visit| {
            let ends = ends[number as usize].map(|end| {
                let place = places[end as usize];
                // A pixel begins half of its side before its centre. Rows of the walk are columns here.
                [1, 0].map(|axis| ((place[axis] - self.whole.min[axis]) as f64 + 0.5) / side)
            });
            let reach = REACH / side + TOLERANCE;
            let size = [self.counts[1], self.counts[0]];
            for_each_cell_within(ends, size, reach, |[row, column]| visit(column * self.counts[1] + row));
        })
    }

    fn cell_of(&self, place: Place) -> usize {
        let [column, row] = [0, 1].map(|axis| ((place[axis] - self.whole.min[axis]) / self.side) as usize);
        column * self.counts[1] + row
    }

    /// Visits the cells that have segments: each with these, and with its places.
    pub(super) fn for_each<E>(
        mut self,
        mut visit: impl FnMut(&Cell, &[u32], &mut [u32]) -> Result<(), E>,
    ) -> Result<(), E> {
        for index in 0..self.len() {
            let segments = self.segments.get(index);
            if segments.is_empty() {
                continue;
            }
            let [column, row] = [index / self.counts[1], index % self.counts[1]].map(|it| it as i64);
            let min = [self.whole.min[0] + column * self.side, self.whole.min[1] + row * self.side];
            let max = [0, 1].map(|axis| (min[axis] + self.side).min(self.whole.max[axis]));
            visit(&Cell { min, max }, segments, self.places.get_mut(index))?;
        }
        Ok(())
    }
}

//! The stream of points, cut into complete cells.

use std::collections::VecDeque;
use std::io::Read;

use super::budget::Held;
use super::cell_buffer::{CellBuffer, Tagged};
use super::duplicates::Merged;
use super::merging::Merging;
use super::residual::Residual;
use spmesh_base::error::Result;
use spmesh_stream::model::bounds::{Point, Region};
use spmesh_stream::model::cells::CellCode;
use spmesh_stream::{Event, StreamReader};

/// Bytes of points, and tags of empty cells, after which a piece tells how many were read: a message for each
/// block would wake the coordinator five times for each cell.
const REPORTED_BYTES: usize = 3 << 19;
const EMPTY_REPORTED: u64 = 1 << 12;

/// The next piece of the stream.
#[derive(Debug)]
pub(super) enum Piece<const D: usize> {
    /// Points or tags were read: the number of points read so far, and what is held now.
    Read { points: u64, held: Held },
    /// A cell is final: it has points, parts that were final before, or completes a cell above it.
    Cell { tagged: Tagged<D>, held: Held },
    /// The stream is complete.
    End(Box<InputSummary<D>>),
}

/// The rest of the input, and its totals.
#[derive(Debug)]
pub(super) struct InputSummary<const D: usize> {
    /// The points of the cells that were never tagged.
    pub(super) rest: Residual<D>,
    /// Points passed on, and points that lie outside of the region.
    pub(super) accepted: u64,
    pub(super) outside: u64,
    /// Points merged with others that they coincide with.
    pub(super) merged: Merged,
    /// Most points held at once.
    pub(super) held_max: usize,
    pub(super) cells: u64,
    pub(super) input_bytes: u64,
}

/// Reads a stream of points, and holds the points of each cell until it is final.
pub(super) struct CellReader<R: Read, const D: usize> {
    reader: StreamReader<R>,
    buffer: CellBuffer<D>,
    /// Tags that were read and not passed on.
    tags: VecDeque<CellCode>,
    cells: u64,
    /// Points after which the next piece is a [`Piece::Read`], points at the last one, and tags of empty
    /// cells since the last piece.
    report: u64,
    reported: u64,
    empty: u64,
}

impl<R: Read, const D: usize> CellReader<R, D> {
    /// A reader that leaves out points outside of `region`.
    pub(super) fn new(reader: StreamReader<R>, region: Region<D>, merging: Merging) -> Self {
        let header = reader.header();
        let buffer = CellBuffer::new(header.tree, region, merging);
        let report = (REPORTED_BYTES / (size_of::<Point>() + header.attributes.row_len())) as u64;
        CellReader { reader, buffer, tags: VecDeque::new(), cells: 0, report, reported: 0, empty: 0 }
    }

    /// The next piece that can be had without reading, which may wait. `fresh` gives empty residuals whose
    /// memory is used again.
    pub(super) fn next_read(&mut self, fresh: &mut impl FnMut() -> Residual<D>) -> Result<Option<Piece<D>>> {
        while let Some(cell) = self.tags.pop_front() {
            self.cells += 1;
            let tagged = self.buffer.tag(cell, &mut *fresh).map_err(|e| self.reader.locate(e))?;
            if !tagged.is_nothing() {
                self.empty = 0;
                return Ok(Some(Piece::Cell { tagged, held: self.buffer.held() }));
            }
            self.empty += 1;
            if self.empty == EMPTY_REPORTED {
                self.empty = 0;
                return Ok(Some(self.read()));
            }
        }
        Ok(None)
    }

    /// The next piece; must not be called after the end. `fresh` is as in [`CellReader::next_read`].
    pub(super) fn next(&mut self, mut fresh: impl FnMut() -> Residual<D>) -> Result<Piece<D>> {
        loop {
            if let Some(piece) = self.next_read(&mut fresh)? {
                return Ok(piece);
            }
            match self.reader.next_event()? {
                Some(Event::Points(points)) => {
                    if let Some(bounds) = self.reader.points_bounds() {
                        let taken = self.buffer.points(&points, self.reader.rows(), &bounds);
                        taken.map_err(|e| self.reader.locate(e))?;
                    }
                    self.reader.give_back(points);
                    let read = self.reader.totals().points;
                    if read - self.reported >= self.report {
                        return Ok(self.read());
                    }
                }
                Some(Event::Cells(cells)) => self.tags.extend(cells),
                Some(Event::End(_)) | None => return Ok(Piece::End(Box::new(self.ended()))),
                Some(_) => {
                    unreachable!("the reader refuses these blocks in a stream of points")
                }
            }
        }
    }

    fn read(&mut self) -> Piece<D> {
        self.reported = self.reader.totals().points;
        Piece::Read { points: self.reported, held: self.buffer.held() }
    }

    fn ended(&mut self) -> InputSummary<D> {
        InputSummary {
            rest: self.buffer.rest(),
            accepted: self.buffer.accepted(),
            outside: self.buffer.outside(),
            merged: self.buffer.merged(),
            held_max: self.buffer.held_max(),
            cells: self.cells,
            input_bytes: self.reader.bytes_read(),
        }
    }
}

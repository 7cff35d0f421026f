//! The stream of points, cut into complete cells.

use std::collections::VecDeque;
use std::io::Read;

use super::cell_buffer::CellBuffer;
use super::duplicates::Merged;
use super::merging::Merging;
use super::residual::Residual;
use spmesh_base::error::Result;
use spmesh_stream::model::bounds::Region;
use spmesh_stream::model::cells::CellCode;
use spmesh_stream::{Event, StreamReader};

/// Points after which a piece tells how many were read: a message for each block would wake the coordinator
/// five times for each cell.
const REPORTED: u64 = 1 << 16;

/// The next piece of the stream.
#[derive(Debug)]
pub(super) enum Piece<const D: usize> {
    /// Points were read and are held: the numbers of points read so far, and held now.
    Points { read: u64, held: usize },
    /// A cell is final.
    Cell {
        cell: CellCode,
        /// Its points, without those of parts that were final before.
        points: Residual<D>,
        /// Whether no part of it was final before.
        is_whole: bool,
    },
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
    /// Points at the last [`Piece::Points`].
    reported: u64,
}

impl<R: Read, const D: usize> CellReader<R, D> {
    /// A reader that leaves out points outside of `region`.
    pub(super) fn new(reader: StreamReader<R>, region: Region<D>, merging: Merging) -> Self {
        let buffer = CellBuffer::new(reader.header().tree, region, merging);
        CellReader { reader, buffer, tags: VecDeque::new(), cells: 0, reported: 0 }
    }

    /// The next piece; must not be called after the end. `fresh` gives empty residuals whose memory is used
    /// again.
    pub(super) fn next(&mut self, fresh: impl FnOnce() -> Residual<D>) -> Result<Piece<D>> {
        loop {
            if let Some(cell) = self.tags.pop_front() {
                self.cells += 1;
                let tagged = self.buffer.tag(cell, fresh());
                let (points, is_whole) = tagged.map_err(|e| self.reader.locate(e))?;
                return Ok(Piece::Cell { cell, points, is_whole });
            }
            match self.reader.next_event()? {
                Some(Event::Points(points)) => {
                    if let Some(bounds) = self.reader.points_bounds() {
                        let taken = self.buffer.points(&points, self.reader.rows(), &bounds);
                        taken.map_err(|e| self.reader.locate(e))?;
                    }
                    self.reader.give_back(points);
                    let read = self.reader.totals().points;
                    if read - self.reported >= REPORTED {
                        self.reported = read;
                        return Ok(Piece::Points { read, held: self.buffer.held() });
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

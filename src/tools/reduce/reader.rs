//! The stream of points, cut into what is complete.

use std::collections::VecDeque;
use std::io::Read;

use super::cell_buffer::Arrivals;
use super::residual::Residual;
use spmesh_core::error::Result;
use spmesh_model::bounds::Region;
use spmesh_model::cells::CellCode;
use spmesh_stream::{Event, StreamReader};

/// What the next piece of the stream brought.
#[derive(Debug)]
pub(super) enum Arrival<const D: usize> {
    /// Nothing yet: so many points were read by now.
    Read(u64),
    /// A cell is final.
    Cell {
        cell: CellCode,
        /// Its points, but for those of parts that were final before.
        points: Residual<D>,
        /// Whether no part of it was final before.
        is_whole: bool,
    },
    /// The stream has ended as it should.
    End(Box<Ended<D>>),
}

/// What was known at the end of the stream.
#[derive(Debug)]
pub(super) struct Ended<const D: usize> {
    /// The points of the cells that were never tagged.
    pub(super) rest: Residual<D>,
    /// Points handed on, and points that lie outside of the region.
    pub(super) accepted: u64,
    pub(super) outside: u64,
    /// Most points held at once.
    pub(super) held_max: usize,
    pub(super) cells: u64,
    pub(super) input_bytes: u64,
}

/// Reads a stream of points, and holds the points of each cell until it is final.
pub(super) struct Intake<R: Read, const D: usize> {
    reader: StreamReader<R>,
    arrivals: Arrivals<D>,
    /// Tags that were read and not handed on.
    tags: VecDeque<CellCode>,
    cells: u64,
}

impl<R: Read, const D: usize> Intake<R, D> {
    /// Points outside of `region` are left out.
    pub(super) fn new(reader: StreamReader<R>, region: Region<D>) -> Self {
        let arrivals = Arrivals::new(reader.header().tree, region);
        Intake { reader, arrivals, tags: VecDeque::new(), cells: 0 }
    }

    /// What comes next; nothing comes after the end. `fresh` gives empty residuals whose memory is used again.
    ///
    /// # Errors
    /// If the stream is malformed, ends too early, or cannot be read.
    pub(super) fn next(&mut self, fresh: impl FnOnce() -> Residual<D>) -> Result<Arrival<D>> {
        loop {
            if let Some(cell) = self.tags.pop_front() {
                self.cells += 1;
                let tagged = self.arrivals.tag(cell, fresh());
                let (points, is_whole) = tagged.map_err(|e| self.reader.locate(e))?;
                return Ok(Arrival::Cell { cell, points, is_whole });
            }
            match self.reader.next_event()? {
                Some(Event::Points(points)) => {
                    if let Some(bounds) = self.reader.points_bounds() {
                        let taken = self.arrivals.points(&points, &bounds);
                        taken.map_err(|e| self.reader.locate(e))?;
                    }
                    self.reader.give_back(points);
                    return Ok(Arrival::Read(self.reader.totals().points));
                }
                Some(Event::Cells(cells)) => self.tags.extend(cells),
                Some(Event::End(_)) | None => return Ok(Arrival::End(Box::new(self.ended()))),
                Some(_) => {
                    unreachable!("the reader refuses these blocks in a stream of points")
                }
            }
        }
    }

    fn ended(&mut self) -> Ended<D> {
        Ended {
            rest: self.arrivals.rest(),
            accepted: self.arrivals.accepted(),
            outside: self.arrivals.outside(),
            held_max: self.arrivals.held_max(),
            cells: self.cells,
            input_bytes: self.reader.bytes_read(),
        }
    }
}

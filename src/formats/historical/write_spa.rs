//! Writes SPA, Isenburg's streaming points as text (`formats/historical.md`).

use std::io::Write;

use crate::historical::write_cells::HistoricalCells;
use crate::sink::world::{world_bounds, world_of, write_numbers};
use crate::sink::{EventSink, expect_kind, lost_of_points, write_error};
use spmesh_base::error::Result;
use spmesh_stream::model::cells::CellCode;
use spmesh_stream::{Event, Header, Kind};

/// Writes points and finalization tags as SPA, in decimals that lose nothing. If there is a finalization
/// tree, the bounding box is the tree's, because its halves are the cells.
pub struct SpaSink<W> {
    output: W,
    header: Header,
    cells: Option<HistoricalCells>,
}

impl<W: Write> SpaSink<W> {
    /// Writes the header lines.
    ///
    /// # Errors
    /// Usage, if SPA does not hold the kind of stream; or if writing fails.
    pub fn new(mut output: W, header: &Header) -> Result<Self> {
        expect_kind(header, "SPA", &[Kind::Points])?;
        let cells = HistoricalCells::of(header);
        output.write_all(b"# SPA written by spmesh\n").map_err(write_error)?;
        if let Some(points) = header.points {
            writeln!(output, "# npoints {points}").map_err(write_error)?;
        }
        let of_points = header.bounds.as_ref().map(|bounds| world_bounds(header, bounds));
        if let Some(bounds) = cells.as_ref().map(HistoricalCells::bounds).or(of_points) {
            write_numbers(&mut output, "# bb_min_d", &bounds.min)?;
            write_numbers(&mut output, "# bb_max_d", &bounds.max)?;
        }
        output.write_all(b"# datatype SP_DOUBLE\n").map_err(write_error)?;
        if let Some(cells) = &cells {
            writeln!(output, "# finalizemethod {}", cells.method()).map_err(write_error)?;
        }
        Ok(SpaSink { output, header: header.clone(), cells })
    }

    fn tags(&mut self, tags: &[CellCode]) -> Result<()> {
        let Some(cells) = &mut self.cells else { return Ok(()) };
        let mut indices = tags.iter().filter_map(|&cell| cells.index(cell));
        indices.try_for_each(|index| writeln!(self.output, "x cell {index}")).map_err(write_error)
    }
}

impl<W: Write> EventSink for SpaSink<W> {
    fn event(&mut self, event: &Event, _rows: &[u8]) -> Result<()> {
        match event {
            Event::Points(points) => points
                .iter()
                .try_for_each(|&point| write_numbers(&mut self.output, "v", &world_of(&self.header, point))),
            Event::Cells(tags) => self.tags(tags),
            Event::End(_) => {
                if let Some(index) = self.cells.as_ref().and_then(HistoricalCells::last_index) {
                    writeln!(self.output, "x cell {index}").map_err(write_error)?;
                }
                self.output.flush().map_err(write_error)
            }
            _ => Ok(()),
        }
    }

    fn notices(&self) -> Vec<String> {
        lost_of_points(&self.header, "SPA", self.cells.as_ref())
    }
}

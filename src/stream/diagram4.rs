//! Reads a whole stream of four-dimensional points or cells.

use std::io::Read;

use super::event::Event;
use super::kind::Kind;
use super::reader::StreamReader;
use crate::model::cells4::Cell4;
use crate::model::diagram4::Diagram4;
use spmesh_base::error::{Error, Result};

/// Collects the blocks of a stream of points or cells of four dimensions.
///
/// Memory: the contents of the stream.
#[derive(Debug, Clone, Default)]
pub struct Diagram4Collector {
    diagram: Diagram4,
    /// Number of 32-bit words of the cells.
    words: u64,
}

impl Diagram4Collector {
    /// An empty collector; `has_values` says whether the points to come have values.
    pub fn new(has_values: bool) -> Self {
        let diagram = Diagram4 { values: has_values.then(Vec::new), ..Diagram4::default() };
        Diagram4Collector { diagram, words: 0 }
    }

    /// Adds the content of a block.
    ///
    /// # Errors
    /// Usage, if the cells have 2^32 words or more.
    ///
    /// # Panics
    /// If streams of points or cells of four dimensions do not have this block.
    pub fn event(&mut self, event: &Event) -> Result<()> {
        match event {
            Event::Points4(block) => {
                self.diagram.points.extend_from_slice(&block.points);
                if let (Some(all), Some(values)) = (&mut self.diagram.values, &block.values) {
                    all.extend_from_slice(values);
                }
            }
            Event::Cells4(cells) => cells.iter().try_for_each(|cell| self.cell(cell))?,
            Event::End(totals) => self.diagram.merged = totals.merged,
            _ => unreachable!("the reader refuses other blocks in these kinds"),
        }
        Ok(())
    }

    fn cell(&mut self, cell: Cell4) -> Result<()> {
        self.words += 2 + (cell.vertices.len() + cell.neighbours.len()) as u64;
        if self.words > u64::from(u32::MAX) {
            return Err(Error::usage("the cells have 2^32 words (17 GB) or more: too many for this program"));
        }
        self.diagram.cells.push(cell);
        Ok(())
    }

    /// The content of the blocks so far.
    pub fn diagram(&self) -> &Diagram4 {
        &self.diagram
    }

    /// The content of all blocks.
    pub fn finish(self) -> Diagram4 {
        self.diagram
    }
}

/// Reads a stream of kind [`Kind::Cells4`] or [`Kind::Points4`] to its end.
///
/// Memory: the contents of the stream.
///
/// # Errors
/// Usage, if the stream is of another kind or its cells have 2^32 words or more; otherwise as
/// [`StreamReader::next_event`].
pub fn read_diagram4<R: Read>(reader: &mut StreamReader<R>) -> Result<Diagram4> {
    let kind = reader.header().kind;
    if !matches!(kind, Kind::Cells4 | Kind::Points4) {
        let message =
            format!("this is a stream of kind {}, expected cells or points in 4 dimensions", kind.name());
        return Err(Error::usage(message).of_input(reader.name()));
    }
    let mut collector = Diagram4Collector::new(reader.header().has_elevation);
    while let Some(event) = reader.next_event()? {
        collector.event(&event).map_err(|error| error.of_input(reader.name()))?;
    }
    Ok(collector.finish())
}

//! Reads a whole stream of four-dimensional points or cells.

use std::io::Read;

use super::event::Event;
use super::kind::Kind;
use super::reader::StreamReader;
use spmesh_core::error::{Error, Result};
use spmesh_model::cells4::{Cell4, Cells4, Point4};

/// Points of four dimensions and the cells between them, as a stream holds them.
#[derive(Debug, Clone, Default)]
pub struct Diagram4 {
    /// The points; sorted, and all different, if the stream is one of cells.
    pub points: Vec<Point4>,
    /// What was measured at each point, NaN where it is not known; `None` if the stream has no values.
    pub values: Option<Vec<f64>>,
    /// The cells; none in a stream of points. All neighbours are cells.
    pub cells: Cells4,
    /// Points of the input that coincide with another and are no vertex of their own.
    pub merged: u64,
}

impl Diagram4 {
    /// Reads a stream of kind [`Kind::Cells4`] or [`Kind::Points4`] to its end.
    ///
    /// Memory: what the stream holds.
    ///
    /// # Errors
    /// Usage, if the stream is of another kind or its cells have 2^32 words or more; otherwise as
    /// [`StreamReader::next_event`].
    pub fn read<R: Read>(reader: &mut StreamReader<R>) -> Result<Self> {
        let kind = reader.header().kind;
        if !matches!(kind, Kind::Cells4 | Kind::Points4) {
            let message =
                format!("this is a stream of kind {}, expected cells or points in 4 dimensions", kind.name());
            return Err(Error::usage(message).of_input(reader.name()));
        }
        let values = reader.header().has_elevation.then(Vec::new);
        let mut diagram = Diagram4 { values, ..Diagram4::default() };
        let mut words = 0;
        while let Some(event) = reader.next_event()? {
            diagram.event(&event, &mut words).map_err(|error| error.of_input(reader.name()))?;
        }
        Ok(diagram)
    }

    /// Takes the next event; `words` counts the words of all cells so far.
    ///
    /// # Errors
    /// Usage, if the cells have 2^32 words or more.
    pub fn event(&mut self, event: &Event, words: &mut u64) -> Result<()> {
        match event {
            Event::Points4(block) => {
                self.points.extend_from_slice(&block.points);
                if let (Some(all), Some(values)) = (&mut self.values, &block.values) {
                    all.extend_from_slice(values);
                }
            }
            Event::Cells4(cells) => cells.iter().try_for_each(|cell| self.cell(cell, words))?,
            Event::End(totals) => self.merged = totals.merged,
            _ => unreachable!("the reader refuses other blocks in these kinds"),
        }
        Ok(())
    }

    fn cell(&mut self, cell: Cell4, words: &mut u64) -> Result<()> {
        *words += 2 + (cell.vertices.len() + cell.neighbours.len()) as u64;
        if *words > u64::from(u32::MAX) {
            return Err(Error::usage("the cells have 2^32 words (17 GB) or more: too many for this program"));
        }
        self.cells.push(cell);
        Ok(())
    }
}

//! Points of any source, as the events of a stream without finalization.

use crate::source::events::EventSource;
use crate::source::input::Input;
use crate::source::reader::PointReader;
use spmesh_base::error::{Error, Result};
use spmesh_stream::{Event, Header, Kind, Totals};

/// The points of an input as events. Memory: a batch.
pub struct PointEvents {
    input: Input,
    header: Header,
    reader: Box<dyn PointReader>,
    points: u64,
    ended: bool,
}

impl PointEvents {
    /// The points of `input`, from its start.
    ///
    /// # Errors
    /// If the input cannot be opened.
    pub fn new(input: Input) -> Result<Self> {
        let description = input.description();
        let mut header =
            Header::new(Kind::Points, description.coordinates, description.dims, description.has_elevation);
        header.crs = description.crs.clone();
        header.attributes = description.attributes.clone();
        let reader = input.read()?;
        Ok(PointEvents { input, header, reader, points: 0, ended: false })
    }
}

impl EventSource for PointEvents {
    fn header(&self) -> &Header {
        &self.header
    }

    fn next_event(&mut self) -> Result<Option<Event>> {
        if self.ended {
            return Ok(None);
        }
        let mut batch = Vec::new();
        self.reader.next_batch(&mut batch)?;
        if batch.is_empty() {
            self.ended = true;
            return Ok(Some(Event::End(Totals { points: self.points, ..Totals::default() })));
        }
        self.points += batch.len() as u64;
        Ok(Some(Event::Points(batch)))
    }

    fn rows(&self) -> &[u8] {
        self.reader.rows()
    }

    fn locate(&self, error: Error) -> Error {
        error.of_input(self.input.name())
    }

    fn notices(&self) -> Vec<String> {
        self.input.notices().iter().cloned().chain(self.input.withheld_notice()).collect()
    }
}

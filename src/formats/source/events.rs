//! The interface of every convertible input: a header, then the events of a spmesh stream.

use std::io::Read;

use spmesh_base::error::{Error, Result};
use spmesh_stream::{Event, Header, StreamReader};

/// An input read as the events of a stream, whatever its format.
pub trait EventSource {
    /// The header.
    fn header(&self) -> &Header;

    /// The next event; the last one is [`Event::End`], which comes only after a complete input, then `None`.
    fn next_event(&mut self) -> Result<Option<Event>>;

    /// The attributes of the points of the last event, row by row, as [`StreamReader::rows`]; empty if the
    /// header lists none.
    fn rows(&self) -> &[u8] {
        &[]
    }

    /// Adds input and position to an error about the event that was read last.
    fn locate(&self, error: Error) -> Error;

    /// Notices for the user about content of the input that the events do not carry.
    fn notices(&self) -> Vec<String> {
        Vec::new()
    }
}

impl<R: Read> EventSource for StreamReader<R> {
    fn header(&self) -> &Header {
        StreamReader::header(self)
    }

    fn next_event(&mut self) -> Result<Option<Event>> {
        StreamReader::next_event(self)
    }

    fn rows(&self) -> &[u8] {
        StreamReader::rows(self)
    }

    fn locate(&self, error: Error) -> Error {
        StreamReader::locate(self, error)
    }
}

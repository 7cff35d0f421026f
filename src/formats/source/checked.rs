//! Streams and text twins with the rules whose check takes memory.

use crate::source::events::EventSource;
use spmesh_base::error::{Error, Result};
use spmesh_stream::{Event, Header, MemoryRules};

/// A source whose events are checked by [`MemoryRules`], too, so that none of its faults goes on to an output.
pub struct Checked<S> {
    source: S,
    rules: MemoryRules,
}

impl<S: EventSource> Checked<S> {
    /// Checks all events of `source`.
    pub fn new(source: S) -> Self {
        let rules = MemoryRules::new(source.header());
        Checked { source, rules }
    }
}

impl<S: EventSource> EventSource for Checked<S> {
    fn header(&self) -> &Header {
        self.source.header()
    }

    fn next_event(&mut self) -> Result<Option<Event>> {
        let event = self.source.next_event()?;
        if let Some(event) = &event {
            self.rules.check(event).map_err(|error| self.source.locate(error))?;
        }
        Ok(event)
    }

    fn rows(&self) -> &[u8] {
        self.source.rows()
    }

    fn locate(&self, error: Error) -> Error {
        self.source.locate(error)
    }

    fn notices(&self) -> Vec<String> {
        self.source.notices()
    }
}

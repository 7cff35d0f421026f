//! The vertices of mesh files of other programs, as points.

use crate::source::events::EventSource;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Event, Header, Totals};

/// Points per event.
pub(crate) const BATCH_POINTS: usize = 1 << 12;

/// Reads vertices one after the other.
pub(crate) trait Vertices {
    /// The next vertex; everything before it is skipped.
    fn next_vertex(&mut self) -> Result<Option<Point>>;

    /// The row of the vertex before; empty if the header lists no attributes.
    fn row(&self) -> &[u8] {
        &[]
    }

    /// Adds the current position to an error.
    fn locate(&self, error: Error) -> Error;
}

/// Vertices as a stream of points. Memory: one batch.
pub(crate) struct VertexPoints<V> {
    vertices: V,
    header: Header,
    rows: Vec<u8>,
    points: u64,
    ended: bool,
}

impl<V: Vertices> VertexPoints<V> {
    /// The points of `vertices`, described by `header`.
    pub(crate) fn new(vertices: V, header: Header) -> Self {
        VertexPoints { vertices, header, rows: Vec::new(), points: 0, ended: false }
    }
}

impl<V: Vertices> EventSource for VertexPoints<V> {
    fn header(&self) -> &Header {
        &self.header
    }

    fn next_event(&mut self) -> Result<Option<Event>> {
        let mut batch: Vec<Point> = Vec::new();
        self.rows.clear();
        while batch.len() < BATCH_POINTS {
            let Some(point) = self.vertices.next_vertex().map_err(|e| self.locate(e))? else { break };
            batch.push(point);
            self.rows.extend_from_slice(self.vertices.row());
        }
        self.points += batch.len() as u64;
        if !batch.is_empty() {
            return Ok(Some(Event::Points(batch)));
        }
        let totals = Totals { points: self.points, ..Totals::default() };
        Ok((!std::mem::replace(&mut self.ended, true)).then_some(Event::End(totals)))
    }

    fn rows(&self) -> &[u8] {
        &self.rows
    }

    fn locate(&self, error: Error) -> Error {
        self.vertices.locate(error)
    }
}

//! Writes the binary stream.

use std::io::Write;

use crate::sink::EventSink;
use spmesh_base::error::Result;
use spmesh_stream::{Event, Header, StreamWriter};

/// Writes its events as a binary stream.
pub struct SpmSink<W: Write> {
    writer: Option<StreamWriter<W>>,
}

impl<W: Write> SpmSink<W> {
    /// Writes the header.
    ///
    /// # Errors
    /// If the header breaks a rule, or writing fails.
    pub fn new(output: W, header: &Header) -> Result<Self> {
        Ok(SpmSink { writer: Some(StreamWriter::new(output, header.clone())?) })
    }
}

impl<W: Write> EventSink for SpmSink<W> {
    fn event(&mut self, event: &Event, rows: &[u8]) -> Result<()> {
        let writer = self.writer.as_mut().expect("no event follows the end");
        match event {
            Event::Points(points) => writer.points_with_rows(points, rows),
            Event::Cells(cells) => writer.cells(cells),
            Event::Region(region) => writer.region(region),
            Event::Patch(patch) => writer.patch_with_rows(patch, rows),
            Event::Labels(labels) => writer.labels(labels),
            Event::ResidualPoints(points) => writer.residual_points_with_rows(points, rows),
            Event::Walls(walls) => writer.walls(walls),
            Event::Points4(points) => writer.points4(&points.points, points.values.as_deref()),
            Event::Cells4(cells) => cells.iter().try_for_each(|cell| writer.cell4(cell)),
            Event::Simplices4(simplices) => writer.simplices4(simplices),
            Event::Configurations(block) => writer.configurations(block),
            Event::Functions(functions) => writer.functions(functions),
            Event::Coefficients(coefficients) => writer.coefficients(coefficients),
            Event::Segments(segments) => writer.segments(segments),
            Event::OpenSegments(segments) => writer.open_segments(segments),
            Event::End(totals) => {
                let writer = self.writer.take().expect("there is one end");
                writer.end(totals.points, totals.merged).map(drop)
            }
        }
    }

    fn notices(&self) -> Vec<String> {
        Vec::new()
    }
}

//! A stream of points that is written again, with one more attribute.

use std::io::{BufReader, Write};

use super::checked::Checked;
use super::events::EventSource;
use super::origin::{Bytes, Origin};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::attributes::{Attribute, Attributes};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::cells::CellCode;
use spmesh_stream::{Event, Header, Kind, StreamReader, StreamWriter};

/// A stream of points with elevations, opened for writing it again.
#[derive(Debug)]
pub struct StreamFile {
    name: String,
    origin: Origin,
    header: Header,
    notices: Vec<String>,
}

impl StreamFile {
    pub(crate) fn new(name: String, origin: Origin, notices: Vec<String>) -> Result<StreamFile> {
        let header = events(&origin, &name)?.header().clone();
        let problem = match header.kind {
            Kind::Points if header.dims == 3 || header.has_elevation => {
                return Ok(StreamFile { name, origin, header, notices });
            }
            Kind::Points => "points have no elevation".to_string(),
            kind => format!("is a stream of kind {}, expected points", kind.name()),
        };
        Err(Error::usage(problem).of_input(name))
    }

    /// Its name in messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Oddities that the user should know.
    pub fn notices(&self) -> &[String] {
        &self.notices
    }

    /// What it states of its points.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Writes the stream again, its points with one more `attribute`: `numbers` replaces the stored numbers
    /// of a batch of about `most` points.
    ///
    /// # Errors
    /// Usage, if points have such an attribute; malformed, if the stream is; if reading, writing or `numbers`
    /// fails.
    pub fn write_with<W: Write>(
        &self,
        attribute: Attribute,
        most: usize,
        output: W,
        mut numbers: impl FnMut(&[Point], &mut Vec<u8>) -> Result<()>,
    ) -> Result<W> {
        let (row_len, width) = (self.header.attributes.row_len(), attribute.width());
        let mut writer = StreamWriter::new(output, self.header_with(attribute)?)?;
        let mut events = events(&self.origin, &self.name)?;
        let (mut batch, mut found, mut row) = (Batch::default(), Vec::new(), Vec::new());
        loop {
            let is_more = batch.fill(&mut *events, most)?;
            numbers(&batch.points, &mut found).map_err(|e| e.of_input(&self.name))?;
            let (mut points, mut new) = (&batch.points[..], found.chunks_exact(width));
            let mut old = batch.rows.chunks_exact(row_len.max(1));
            for piece in &batch.pieces {
                match piece {
                    Piece::Points(count) => {
                        let (now, later) = points.split_at(*count);
                        row.clear();
                        for new in new.by_ref().take(*count) {
                            row.extend_from_slice(old.next().unwrap_or(&[]));
                            row.extend_from_slice(new);
                        }
                        writer.points_with_rows(now, &row)?;
                        points = later;
                    }
                    Piece::Cells(cells) => writer.cells(cells)?,
                }
            }
            if !is_more {
                return writer.end(0, 0);
            }
        }
    }

    fn header_with(&self, attribute: Attribute) -> Result<Header> {
        let name = attribute.name.clone();
        let attributes = self.header.attributes.iter().cloned().chain([attribute]).collect();
        let refused =
            |_| Error::usage(format!("points have an attribute {name} already: make the stream without"));
        let attributes = Attributes::new(attributes).map_err(refused).map_err(|e| e.of_input(&self.name))?;
        let Header { producer, .. } = Header::new(Kind::Points, self.header.coordinates, 2, true);
        Ok(Header { attributes, producer, ..self.header.clone() })
    }
}

type PointEvents = Box<dyn EventSource>;

fn events(origin: &Origin, name: &str) -> Result<PointEvents> {
    let bytes: Bytes = origin.plain().map_err(|e| e.of_input(name))?;
    let input = BufReader::with_capacity(1 << 18, bytes);
    Ok(Box::new(Checked::new(StreamReader::new(input, name)?)))
}

/// Some events of a stream.
#[derive(Default)]
struct Batch {
    points: Vec<Point>,
    rows: Vec<u8>,
    pieces: Vec<Piece>,
}

enum Piece {
    /// So many points more.
    Points(usize),
    Cells(Vec<CellCode>),
}

impl Batch {
    /// Replaces the content with the next events, of `most` points or hardly more. Returns whether the end is
    /// not among them.
    fn fill(&mut self, events: &mut dyn EventSource, most: usize) -> Result<bool> {
        self.points.clear();
        self.rows.clear();
        self.pieces.clear();
        while self.points.len() < most && self.pieces.len() < most {
            match events.next_event()? {
                None => return Ok(false),
                Some(Event::Points(points)) => {
                    self.pieces.push(Piece::Points(points.len()));
                    self.points.extend_from_slice(&points);
                    self.rows.extend_from_slice(events.rows());
                }
                Some(Event::Cells(cells)) => self.pieces.push(Piece::Cells(cells)),
                // A stream of points has no others, but its end.
                Some(_) => {}
            }
        }
        Ok(true)
    }
}

//! Writes lines as GeoJSON.

use std::io::Write;

use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::Point2;
use spmesh_formats::crs::System;
use spmesh_formats::source::{collection_head, epsg_code};
use spmesh_stream::Crs;

/// The format of lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineFormat {
    /// GeoJSON: one collection of features, which states the coordinate reference system.
    GeoJson,
    /// Newline-delimited GeoJSON: a feature on each line.
    GeoJsonLines,
}

/// Length of the buffer that is written at once. Units: bytes.
const CHUNK_LEN: usize = 1 << 16;

/// Writes lines as features. Coordinates are those of the stream.
pub(super) struct LineWriter<W> {
    output: W,
    format: LineFormat,
    text: Vec<u8>,
    /// The property for the unit of elevations, as JSON behind a comma; empty if the unit is unknown.
    unit: String,
    /// Number of features written.
    features: u64,
}

impl<W: Write> LineWriter<W> {
    /// Starts the output.
    pub(super) fn new(output: W, format: LineFormat, crs: &Crs) -> LineWriter<W> {
        let mut text = Vec::with_capacity(2 * CHUNK_LEN);
        if format == LineFormat::GeoJson {
            text.extend_from_slice(collection_head(epsg_code(crs)).as_bytes());
        }
        let unit = System::of(crs).vertical.map_or(String::new(), |vertical| {
            format!(",\"unit\":{}", serde_json::Value::from(vertical.unit.symbol))
        });
        LineWriter { output, format, text, unit, features: 0 }
    }

    /// Writes a line of at least two points, in world coordinates, and what is true of it. A ring repeats its
    /// first point at the end.
    pub(super) fn line(
        &mut self,
        elevation: f64,
        truths: [(&str, bool); 3],
        points: impl Iterator<Item = Point2>,
    ) -> Result<()> {
        if self.format == LineFormat::GeoJson {
            self.text.extend_from_slice(if self.features > 0 { b",\n" } else { b"\n" });
        }
        self.features += 1;
        self.text.extend_from_slice(br#"{"type":"Feature","properties":{"elevation":"#);
        self.number(elevation)?;
        self.text.extend_from_slice(self.unit.as_bytes());
        for (name, is_true) in truths {
            write!(self.text, ",\"{name}\":{is_true}").map_err(write_error)?;
        }
        self.text.extend_from_slice(br#"},"geometry":{"type":"LineString","coordinates":["#);
        for (count, [x, y]) in points.enumerate() {
            self.text.extend_from_slice(if count > 0 { b",[" } else { b"[" });
            self.number(x)?;
            self.text.push(b',');
            self.number(y)?;
            self.text.push(b']');
            self.hand_over(CHUNK_LEN)?;
        }
        self.text.extend_from_slice(b"]}}");
        if self.format == LineFormat::GeoJsonLines {
            self.text.push(b'\n');
        }
        self.hand_over(CHUNK_LEN)
    }

    /// Ends the output.
    pub(super) fn end(mut self) -> Result<()> {
        if self.format == LineFormat::GeoJson {
            self.text.extend_from_slice(b"\n]}\n");
        }
        self.hand_over(0)?;
        self.output.flush().map_err(write_error)
    }

    /// Writes the shortest decimal that reads back as the same number; zero has no sign.
    ///
    /// Domain: finite numbers.
    fn number(&mut self, value: f64) -> Result<()> {
        serde_json::to_writer(&mut self.text, &(value + 0.0)).map_err(|cause| write_error(cause.into()))?;
        if self.text.ends_with(b".0") {
            self.text.truncate(self.text.len() - 2);
        }
        Ok(())
    }

    fn hand_over(&mut self, len: usize) -> Result<()> {
        if self.text.len() >= len {
            self.output.write_all(&self.text).map_err(write_error)?;
            self.text.clear();
        }
        Ok(())
    }
}

fn write_error(cause: std::io::Error) -> Error {
    Error::io("writing", cause)
}

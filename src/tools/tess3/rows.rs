//! Rows of tables: fields that tabs separate, written in pieces.

use std::fmt::Display;
use std::io::Write;

use super::number::write_number;
use spmesh_core::error::{Error, Result};
use spmesh_geometry::predicates::Point3;

/// Bytes of rows that are buffered before they are written.
const ROWS_LEN: usize = 1 << 16;

/// A buffer of rows.
pub(super) struct Rows<'o, W> {
    output: &'o mut W,
    text: Vec<u8>,
}

impl<'o, W: Write> Rows<'o, W> {
    pub(super) fn new(output: &'o mut W) -> Self {
        Rows { output, text: Vec::new() }
    }

    /// Starts a row with the number of the model.
    pub(super) fn start(&mut self, model: i64) -> Result<()> {
        write!(self.text, "{model}").map_err(write_error)
    }

    pub(super) fn field(&mut self, text: &str) {
        self.text.push(b'\t');
        self.text.extend_from_slice(text.as_bytes());
    }

    pub(super) fn integer(&mut self, value: impl Display) -> Result<()> {
        write!(self.text, "\t{value}").map_err(write_error)
    }

    pub(super) fn number(&mut self, value: f64) -> Result<()> {
        self.text.push(b'\t');
        write_number(&mut self.text, value).map_err(write_error)
    }

    pub(super) fn end(&mut self) -> Result<()> {
        self.text.push(b'\n');
        if self.text.len() >= ROWS_LEN { self.finish() } else { Ok(()) }
    }

    /// Writes the buffered rows to the output.
    pub(super) fn finish(&mut self) -> Result<()> {
        self.output.write_all(&self.text).map_err(write_error)?;
        self.text.clear();
        Ok(())
    }
}

/// Distance of two points.
pub(super) fn distance([p, q]: [Point3; 2]) -> f64 {
    (0..3).map(|axis| (p[axis] - q[axis]).powi(2)).sum::<f64>().sqrt()
}

pub(super) fn write_error(cause: std::io::Error) -> Error {
    Error::io("writing the table", cause)
}

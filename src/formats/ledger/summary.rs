//! The summary of a batch: a row for each output, or for each file that failed.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;

use super::done::Done;
use super::lock::{Lock, lock};
use super::row::{Columns, Format, Row, table_columns};
use crate::tables::{TableFormat, TableSink};
use spmesh_base::error::{Error, Result};
use spmesh_base::output::Output;

/// Writes a summary, which is a file, once more as Parquet.
pub(super) fn write_parquet(summary: &Path, columns: Columns, output: Output) -> Result<()> {
    let failed = |e| Error::io("reading the summary", e).of_input(summary.display().to_string());
    let lines = BufReader::new(fs::File::open(summary).map_err(failed)?).lines();
    let format = Format::of(summary);
    let mut table = TableSink::create(TableFormat::Parquet, table_columns(columns), output);
    for line in lines.skip(format.head(columns).lines().count()) {
        if let Some(row) = format.row(&line.map_err(failed)?, columns) {
            row.write(&mut table)?;
        }
    }
    table.commit()
}

/// The summary while it is written. Each file's rows are there as soon as the file is done.
pub(super) struct Summary {
    name: String,
    format: Format,
    output: Box<dyn Write + Send>,
    text: String,
    /// Keeps other runs out.
    _lock: Option<Lock>,
}

impl Summary {
    /// Begins a summary with the rows of what was done before; "-" is stdout.
    pub(super) fn create(path: &Path, columns: Columns, done: &Done) -> Result<Summary> {
        let format = Format::of(path);
        let mut summary = Summary {
            name: path.display().to_string(),
            format,
            output: Box::new(std::io::sink()),
            text: std::iter::once(format.head(columns)).chain(done.lines(format)).collect(),
            _lock: None,
        };
        if path == Path::new("-") {
            summary.output = Box::new(Output::create(path, false)?);
            summary.name = "stdout".into();
        } else {
            // The file is replaced atomically: a kill here must not lose the summary of the earlier run.
            let mut start = Output::create(path, false)?;
            start.write_all(summary.text.as_bytes()).map_err(|e| summary.failed(e))?;
            start.commit()?;
            let file = fs::OpenOptions::new().append(true).open(path).map_err(|e| summary.failed(e))?;
            summary.output = Box::new(file);
            summary.text.clear();
            // Another run may have locked the new file already: then it goes on, and this one does not.
            summary._lock = lock(path)?;
        }
        summary.flush()?;
        Ok(summary)
    }

    /// Adds the rows of a file, in one piece.
    pub(super) fn add(&mut self, rows: &[Row]) -> Result<()> {
        rows.iter().for_each(|row| self.text += &self.format.line(row));
        self.flush()
    }

    fn flush(&mut self) -> Result<()> {
        let written = self.output.write_all(self.text.as_bytes()).and_then(|()| self.output.flush());
        self.text.clear();
        written.map_err(|e| self.failed(e))
    }

    fn failed(&self, cause: std::io::Error) -> Error {
        Error::io("writing the summary", cause).of_input(&self.name)
    }
}

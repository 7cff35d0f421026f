//! The summary of a sweep: a row per mesh, or per file that failed. `--resume` reads it to find the files
//! that are done.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::time::Duration;

use super::done::{Done, Input, Lock, lock};
use super::row::{Format, Row, columns};
use crate::tess3::Report;
use spmesh_base::error::{Error, Result};
use spmesh_base::output::Output;
use spmesh_formats::sink::{TableFormat, TableSink};

/// Writes a summary, which is a file, once more as Parquet.
pub(super) fn write_parquet(summary: &Path, output: Output) -> Result<()> {
    let failed = |e| Error::io("reading the summary", e).of_input(summary.display().to_string());
    let lines = BufReader::new(fs::File::open(summary).map_err(failed)?).lines();
    let format = Format::of(summary);
    let mut table = TableSink::create(TableFormat::Parquet, columns(), output);
    for line in lines.skip(format.head().lines().count()) {
        if let Some(row) = format.row(&line.map_err(failed)?) {
            row.write(&mut table)?;
        }
    }
    table.commit()
}

/// The data of a row.
#[derive(Debug)]
pub(super) struct Line<'l> {
    pub(super) file: &'l Path,
    pub(super) options: &'l str,
    pub(super) version: &'l str,
    pub(super) time: Duration,
    /// Peak memory for the file in bytes, if it was measured.
    pub(super) peak_memory: Option<u64>,
    /// The file as it was read, if it is a regular one.
    pub(super) input: Option<&'l Input>,
    pub(super) result: std::result::Result<Written<'l>, &'l Error>,
}

/// The output of a model.
#[derive(Debug)]
pub(super) struct Written<'l> {
    pub(super) report: &'l Report,
    /// Path of the output, relative to the folder of outputs.
    pub(super) output: &'l Path,
    pub(super) bytes: u64,
    pub(super) warnings: &'l [String],
}

impl Line<'_> {
    fn row(&self) -> Row {
        let mut row = Row::default();
        row.set("file", self.file.to_string_lossy());
        row.set("options", self.options);
        row.set("version", self.version);
        row.set("seconds", format!("{:.6}", self.time.as_secs_f64()));
        row.set("peak_memory_bytes", self.peak_memory.map_or(String::new(), |bytes| bytes.to_string()));
        if let Some(Input { bytes, modified, sha256 }) = self.input {
            row.set("input_bytes", bytes.to_string());
            row.set("input_modified", modified);
            row.set("input_sha256", sha256);
        }
        match &self.result {
            Ok(Written { report, output, bytes, warnings }) => {
                let Report { model, atoms, vertices, tetrahedra, hull_facets, .. } = report;
                row.set("model", model.to_string());
                row.set("atoms", atoms.to_string());
                if !report.is_of_cells {
                    row.set("unique_points", vertices.to_string());
                    row.set("tetrahedra", tetrahedra.to_string());
                    row.set("hull_facets", hull_facets.to_string());
                }
                row.set(
                    "violations",
                    report.rounding.violations.map_or(String::new(), |count| count.to_string()),
                );
                row.set("output", output.to_string_lossy());
                row.set("output_bytes", bytes.to_string());
                row.set("warnings", warnings.join("; "));
            }
            Err(error) => row.set("error", error.to_string()),
        }
        row
    }
}

/// The summary while it is written. Each file's rows are there as soon as the file is done.
pub(super) struct Summary {
    name: String,
    format: Format,
    output: Box<dyn Write + Send>,
    text: String,
    /// Keeps other sweeps out.
    _lock: Option<Lock>,
}

impl Summary {
    /// Begins a summary with the rows of what was done before; "-" is stdout.
    pub(super) fn create(path: &Path, done: &Done) -> Result<Summary> {
        let format = Format::of(path);
        let mut summary = Summary {
            name: path.display().to_string(),
            format,
            output: Box::new(std::io::sink()),
            text: std::iter::once(format.head()).chain(done.lines(format)).collect(),
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
            // Another sweep may have locked the new file already: then it goes on, and this one does not.
            summary._lock = lock(path)?;
        }
        summary.flush()?;
        Ok(summary)
    }

    /// Adds the rows of a file, in one piece.
    pub(super) fn add(&mut self, lines: &[Line<'_>]) -> Result<()> {
        lines.iter().for_each(|line| self.text += &self.format.line(&line.row()));
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

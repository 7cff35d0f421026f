//! The summary of a sweep: a line per mesh, or per file that failed. It is also the memory of what is done.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::Report;
use spmesh_core::error::{Error, Result};
use spmesh_core::output::Output;

const COLUMNS: &str = "file\tmodel\tatoms\tunique_points\ttetrahedra\thull_facets\tseconds\tpeak_memory_bytes\t\
                       output\toutput_bytes\toptions\terror";

/// Number of columns, and places of some of them.
const WIDTH: usize = 12;
const FILE: usize = 0;
const OUTPUT: usize = 8;
const OUTPUT_BYTES: usize = 9;
const OPTIONS: usize = 10;
const ERROR: usize = 11;

/// A line to be.
#[derive(Debug)]
pub(super) struct Line<'l> {
    pub(super) file: &'l Path,
    pub(super) options: &'l str,
    pub(super) time: Duration,
    /// Most memory that the work on the file took, in bytes, where it was measured.
    pub(super) peak_memory: Option<u64>,
    pub(super) result: std::result::Result<Written<'l>, &'l Error>,
}

/// What was written of a model.
#[derive(Debug)]
pub(super) struct Written<'l> {
    pub(super) report: &'l Report,
    /// Path of the output, relative to the folder of outputs.
    pub(super) output: &'l Path,
    pub(super) bytes: u64,
}

impl Line<'_> {
    fn print(&self, text: &mut String) {
        let peak_memory = self.peak_memory.map_or(String::new(), |bytes| bytes.to_string());
        let seconds = format!("{:.6}", self.time.as_secs_f64());
        let mut fields: [String; WIDTH] = Default::default();
        fields[FILE] = escaped(&self.file.to_string_lossy());
        fields[6..8].clone_from_slice(&[seconds, peak_memory]);
        fields[OPTIONS] = escaped(self.options);
        match &self.result {
            Ok(Written { report, output, bytes }) => {
                let Report { model, atoms, vertices, tetrahedra, hull_facets, .. } = report;
                fields[1] = model.to_string();
                for (field, count) in fields[2..6].iter_mut().zip([atoms, vertices, tetrahedra, hull_facets])
                {
                    *field = count.to_string();
                }
                fields[OUTPUT] = escaped(&output.to_string_lossy());
                fields[OUTPUT_BYTES] = bytes.to_string();
            }
            Err(error) => fields[ERROR] = escaped(&error.to_string()),
        }
        *text += &fields.join("\t");
        text.push('\n');
    }
}

/// Text without tabs and ends of lines, so that it fits a field.
fn escaped(text: &str) -> String {
    text.replace('\\', "\\\\").replace('\t', "\\t").replace('\n', "\\n").replace('\r', "\\r")
}

/// What an earlier run has done: for each of its files the lines, if none of them says that it failed.
#[derive(Debug, Default)]
pub(super) struct Done {
    by_file: HashMap<String, DoneFile>,
}

/// A file that is done.
#[derive(Debug, Default)]
pub(super) struct DoneFile {
    lines: Vec<String>,
    options: String,
    /// Outputs with their lengths in bytes.
    pub(super) outputs: Vec<(PathBuf, u64)>,
}

impl Done {
    /// Reads the summary of an earlier run; nothing is done if there is none. A last line that is not
    /// complete does not count.
    ///
    /// # Errors
    /// If the file cannot be read, or is no such summary.
    pub(super) fn read(path: &Path) -> Result<Done> {
        let name = path.display();
        let text = match fs::read(path) {
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(Done::default()),
            other => other.map_err(|e| Error::io("reading the summary", e).of_input(name.to_string()))?,
        };
        let text = String::from_utf8_lossy(&text);
        let complete = text.rfind('\n').map_or("", |end| &text[..end]);
        let mut lines = complete.lines();
        if lines.next().is_some_and(|columns| columns != COLUMNS) {
            let message = "not a summary of tess3: its first line has other columns";
            return Err(Error::usage(message).of_input(name.to_string()));
        }
        let mut done = Done::default();
        for line in lines {
            done.add(line);
        }
        done.by_file.retain(|_, file| !file.outputs.is_empty());
        Ok(done)
    }

    fn add(&mut self, line: &str) {
        let fields: Vec<&str> = line.split('\t').collect();
        if fields.len() != WIDTH {
            return;
        }
        let file = self.by_file.entry(fields[FILE].to_string()).or_default();
        let Ok(bytes) = fields[OUTPUT_BYTES].parse() else { return };
        file.options = fields[OPTIONS].to_string();
        file.outputs.push((unescaped(fields[OUTPUT]).into(), bytes));
        file.lines.push(line.to_string());
    }

    /// The file, if it is done with the same options.
    pub(super) fn file(&self, path: &Path, options: &str) -> Option<&DoneFile> {
        let file = self.by_file.get(&escaped(&path.to_string_lossy()))?;
        (file.options == escaped(options)).then_some(file)
    }

    /// Forgets a file, which is to be done again.
    pub(super) fn forget(&mut self, path: &Path) {
        self.by_file.remove(&escaped(&path.to_string_lossy()));
    }

    /// Names of all outputs without their endings, and without each of their endings.
    pub(super) fn stems(&self) -> HashSet<PathBuf> {
        let outputs = self.by_file.values().flat_map(|file| &file.outputs);
        let stems = outputs.flat_map(|(output, _)| {
            std::iter::successors(Some(output.with_extension("")), |stem| {
                stem.extension().map(|_| stem.with_extension(""))
            })
        });
        stems.collect()
    }

    fn lines(&self) -> Vec<&str> {
        let mut lines: Vec<&str> =
            self.by_file.values().flat_map(|file| &file.lines).map(|line| &line[..]).collect();
        lines.sort_unstable();
        lines
    }
}

fn unescaped(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut rest = text.chars();
    while let Some(next) = rest.next() {
        plain.push(match next {
            '\\' => match rest.next() {
                Some('t') => '\t',
                Some('n') => '\n',
                Some('r') => '\r',
                other => other.unwrap_or('\\'),
            },
            other => other,
        });
    }
    plain
}

/// The summary while it is written. Each file's lines are there as soon as the file is done.
pub(super) struct Summary {
    name: String,
    output: Box<dyn Write + Send>,
    text: String,
}

impl Summary {
    /// Begins a summary with the lines of what was done before; "-" is stdout.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn create(path: &Path, done: &Done) -> Result<Summary> {
        let mut summary = Summary {
            name: path.display().to_string(),
            output: Box::new(std::io::sink()),
            text: String::new(),
        };
        summary.text = std::iter::once(COLUMNS).chain(done.lines()).flat_map(|line| [line, "\n"]).collect();
        if path == Path::new("-") {
            summary.output = Box::new(Output::create(path, false)?);
            summary.name = "stdout".into();
        } else {
            // What an earlier run has written must not be lost if this one is killed here.
            let mut start = Output::create(path, false)?;
            start.write_all(summary.text.as_bytes()).map_err(|e| summary.failed(e))?;
            start.commit()?;
            let file = fs::OpenOptions::new().append(true).open(path).map_err(|e| summary.failed(e))?;
            summary.output = Box::new(file);
            summary.text.clear();
        }
        summary.flush()?;
        Ok(summary)
    }

    /// Adds the lines of a file, in one piece.
    ///
    /// # Errors
    /// If they cannot be written.
    pub(super) fn add(&mut self, lines: Vec<Line<'_>>) -> Result<()> {
        lines.iter().for_each(|line| line.print(&mut self.text));
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

//! What an earlier run has done, as its summary says.

use std::collections::HashMap;
use std::fs::{self, Metadata};
use std::path::{Component, Path, PathBuf};

use super::row::{Format, Row};
use super::state::{FileState, modified_of};
use super::{Batch, OUTPUT_TIME};
use spmesh_base::error::{Error, Result};

/// The files that an earlier run has done, with their rows; files that failed are left out.
#[derive(Debug, Default)]
pub(super) struct Done {
    by_file: HashMap<String, DoneFile>,
}

/// The rows of a file that an earlier run has done.
#[derive(Debug, Default)]
pub struct DoneFile {
    rows: Vec<Row>,
}

impl DoneFile {
    /// Paths of its outputs, relative to the folder of outputs. Those that would leave it are no outputs.
    pub fn outputs(&self) -> impl Iterator<Item = PathBuf> {
        self.rows.iter().map(|row| PathBuf::from(row.get("output"))).filter(|output| is_inside(output))
    }

    /// One of the states that its rows hold: that of the file, or of another one that it depends on.
    pub(super) fn state(&self, prefix: &str) -> Option<FileState> {
        FileState::of_row(self.rows.first()?, prefix)
    }

    /// Whether its outputs in a folder are those of the rows, by length, and by time where rows state it.
    /// `is_whole` looks further into each.
    fn has_outputs(&self, folder: &Path, is_whole: &dyn Fn(&Path) -> bool) -> bool {
        self.rows.iter().all(|row| {
            let path = folder.join(row.get("output"));
            let is_same = |found: &Metadata| {
                found.is_file()
                    && row.get("output_bytes").parse() == Ok(found.len())
                    && row.find(OUTPUT_TIME).is_none_or(|time| time == modified_of(found))
            };
            fs::metadata(&path).is_ok_and(|found| is_same(&found)) && is_whole(&path)
        })
    }

    /// Whether its outputs are still there, and the file has not changed.
    pub(super) fn is_still_there(
        &self,
        file: &Path,
        folder: &Path,
        is_whole: &dyn Fn(&Path) -> bool,
    ) -> bool {
        self.has_outputs(folder, is_whole) && self.state("input").is_some_and(|input| input.is_still(file))
    }
}

impl Done {
    /// Reads the summary of an earlier run; empty if there is none. An incomplete last line is ignored.
    pub(super) fn read(path: &Path, batch: &Batch) -> Result<Done> {
        let name = path.display();
        let text = match fs::read(path) {
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(Done::default()),
            other => other.map_err(|e| Error::io("reading the summary", e).of_input(name.to_string()))?,
        };
        let text = String::from_utf8_lossy(&text);
        let complete = text.rfind('\n').map_or("", |end| &text[..=end]);
        let (format, columns) = (Format::of(path), batch.columns);
        let head = format.head(columns);
        let Some(rows) = (if complete.is_empty() { Some("") } else { complete.strip_prefix(&head) }) else {
            let message = format!(
                "not a summary of this version of {}: its first line has other columns. Run it without \
                 --resume, or give another --summary",
                batch.program
            );
            return Err(Error::usage(message).of_input(name.to_string()));
        };
        let mut done = Done::default();
        for row in rows.lines().filter_map(|line| format.row(line, columns)) {
            if row.get("output_bytes").parse::<u64>().is_ok() {
                done.by_file.entry(row.get("file").to_string()).or_default().rows.push(row);
            }
        }
        Ok(done)
    }

    /// The file, if it is done with the same options by the same version. A name that is not UTF-8 is written
    /// with other characters, which may be the name of another file: it counts as not done.
    pub(super) fn file(&self, path: &Path, options: &str, version: &str) -> Option<&DoneFile> {
        let file = self.by_file.get(path.to_str()?)?;
        let is_same = |row: &Row| row.get("options") == options && row.get("version") == version;
        file.rows.iter().all(is_same).then_some(file)
    }

    /// Takes out a file, which will be done again.
    pub(super) fn take(&mut self, path: &Path) -> Option<DoneFile> {
        self.by_file.remove(path.to_str()?)
    }

    /// Files with their outputs, relative to the folder.
    pub(super) fn outputs(&self) -> impl Iterator<Item = (&Path, PathBuf)> {
        self.by_file
            .iter()
            .flat_map(|(file, done)| done.outputs().map(move |output| (Path::new(&file[..]), output)))
    }

    /// The rows of all files, in the order of their lines.
    pub(super) fn lines(&self, format: Format) -> Vec<String> {
        let rows = self.by_file.values().flat_map(|file| &file.rows);
        let mut lines: Vec<String> = rows.map(|row| format.line(row)).collect();
        lines.sort_unstable();
        lines
    }
}

/// Whether a path of a summary stays in the folder of outputs.
fn is_inside(output: &Path) -> bool {
    output.components().all(|part| matches!(part, Component::Normal(_)))
}

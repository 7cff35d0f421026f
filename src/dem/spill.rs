//! The temporary file for tiles that memory has no room for: records of one length, used again.

use std::fs::File;
use std::io;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};

use super::tile::Tile;
use crate::error::{Error, Result};

/// A file without a name, so that nothing is left of it however the process ends; made when it is needed first.
#[derive(Debug)]
pub(super) struct Spill {
    folder: PathBuf,
    file: Option<File>,
    /// Number of records in the file.
    records: u32,
    /// Records that can be used again.
    free: Vec<u32>,
}

impl Spill {
    /// Nothing so far; the file is going to be in `folder`, or in the system's folder for temporary files.
    pub(super) fn new(folder: Option<&Path>) -> Spill {
        let folder = folder.map_or_else(std::env::temp_dir, Path::to_path_buf);
        Spill { folder, file: None, records: 0, free: Vec::new() }
    }

    /// Bytes of the file.
    pub(super) fn len(&self) -> u64 {
        u64::from(self.records) * Tile::LEN
    }

    /// Keeps a tile; the number of its record.
    ///
    /// # Errors
    /// If the file cannot be made or written.
    pub(super) fn put(&mut self, tile: &Tile) -> Result<u32> {
        let record = self.free.pop().unwrap_or(self.records);
        let written = self.file().and_then(|file| {
            let ([values, owned], [of_values, of_owned]) = (tile.bytes(), offsets(record));
            file.write_all_at(values, of_values)?;
            file.write_all_at(owned, of_owned)
        });
        written.map_err(|cause| self.error("writing tiles that exceed --memory", cause))?;
        self.records = self.records.max(record + 1);
        Ok(record)
    }

    /// Reads a tile that was kept.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub(super) fn read(&mut self, record: u32, tile: &mut Tile) -> Result<()> {
        let read = self.file().and_then(|file| {
            tile.fill(|[values, owned]| {
                let [of_values, of_owned] = offsets(record);
                file.read_exact_at(values, of_values)?;
                file.read_exact_at(owned, of_owned)
            })
        });
        read.map_err(|cause| self.error("reading tiles back", cause))
    }

    /// Lets a record be used again.
    pub(super) fn forget(&mut self, record: u32) {
        self.free.push(record);
    }

    fn file(&mut self) -> io::Result<&File> {
        match &mut self.file {
            Some(file) => Ok(file),
            none => Ok(none.insert(tempfile::tempfile_in(&self.folder)?)),
        }
    }

    fn error(&self, what: &str, cause: io::Error) -> Error {
        Error::io(what, cause).of_input(format!("temporary file in {}", self.folder.display()))
    }
}

/// Where values and bits of a record are.
fn offsets(record: u32) -> [u64; 2] {
    let start = u64::from(record) * Tile::LEN;
    [start, start + Tile::VALUES_LEN]
}

//! Records of one length in a temporary file, whose slots are used again.

use std::path::{Path, PathBuf};

use super::TemporaryFile;
use crate::error::Result;

/// Records that do not fit memory. The file is created by the first access.
#[derive(Debug)]
pub struct Records {
    folder: Option<PathBuf>,
    file: Option<TemporaryFile>,
    record_len: u64,
    /// Number of records in the file.
    count: u32,
    /// Free slots.
    free: Vec<u32>,
}

impl Records {
    /// No records; the file will be in `folder`, or in the system's folder for temporary files.
    pub fn new(folder: Option<&Path>, record_len: u64) -> Records {
        let folder = folder.map(Path::to_path_buf);
        Records { folder, file: None, record_len, count: 0, free: Vec::new() }
    }

    /// Bytes of the file.
    pub fn file_len(&self) -> u64 {
        u64::from(self.count) * self.record_len
    }

    /// Allocates a record and returns its number. Its content is unspecified.
    pub fn add(&mut self) -> u32 {
        self.free.pop().unwrap_or_else(|| {
            self.count += 1;
            self.count - 1
        })
    }

    /// Frees a record.
    pub fn forget(&mut self, record: u32) {
        self.free.push(record);
    }

    /// Writes bytes at an offset within a record; `what` describes the operation in messages.
    ///
    /// # Errors
    /// If the file cannot be created or written.
    pub fn write(&mut self, what: &str, record: u32, at: u64, bytes: &[u8]) -> Result<()> {
        let offset = u64::from(record) * self.record_len + at;
        self.file()?.write_at(what, bytes, offset)
    }

    /// Reads bytes at an offset within a record; `what` describes the operation in messages.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn read(&mut self, what: &str, record: u32, at: u64, bytes: &mut [u8]) -> Result<()> {
        let offset = u64::from(record) * self.record_len + at;
        self.file()?.read_at(what, bytes, offset)
    }

    fn file(&mut self) -> Result<&TemporaryFile> {
        match &mut self.file {
            Some(file) => Ok(file),
            none => Ok(none.insert(TemporaryFile::create(self.folder.as_deref())?)),
        }
    }
}

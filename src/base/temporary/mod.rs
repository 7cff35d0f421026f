//! Temporary files.

mod frozen;
mod names;
mod orphans;
mod records;

use std::fs::File;
use std::io::{self, Write};
use std::os::unix::fs::FileExt;
use std::path::Path;

use crate::error::{Error, Result};
pub use frozen::{FrozenFile, Windows};
pub(crate) use names::Name;
pub use names::remove_names_at_signals;
pub(crate) use orphans::own_prefix;
pub use orphans::remove_orphans;
pub use records::Records;

/// The cause of a failure of `tempfile`, which adds a made-up path to it.
pub(crate) fn without_path(error: io::Error) -> io::Error {
    let cause = error.get_ref().and_then(|e| e.source()).and_then(|e| e.downcast_ref::<io::Error>());
    cause.and_then(io::Error::raw_os_error).map_or(error, io::Error::from_raw_os_error)
}

/// A file without a name, so that nothing of it is left however the process ends.
#[derive(Debug)]
pub struct TemporaryFile {
    file: File,
    /// Name in messages.
    name: String,
}

impl TemporaryFile {
    /// An empty file in `folder`, or in the system's folder for temporary files.
    ///
    /// # Errors
    /// If the file cannot be created.
    pub fn create(folder: Option<&Path>) -> Result<TemporaryFile> {
        let folder = folder.map_or_else(std::env::temp_dir, Path::to_path_buf);
        let name = format!("temporary file in {}", folder.display());
        let file = tempfile::tempfile_in(&folder)
            .map_err(|e| Error::io("creating it", without_path(e)).of_input(&name))?;
        Ok(TemporaryFile { file, name })
    }

    /// Its name in messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The file without its name.
    pub fn into_file(self) -> File {
        self.file
    }

    /// Writes bytes behind those that this method wrote before; `what` describes the operation in messages.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn append(&self, what: &str, bytes: &[u8]) -> Result<()> {
        (&self.file).write_all(bytes).map_err(|e| self.error(what, e))
    }

    /// Writes bytes at an offset; `what` describes the operation in messages.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write_at(&self, what: &str, bytes: &[u8], offset: u64) -> Result<()> {
        self.file.write_all_at(bytes, offset).map_err(|e| self.error(what, e))
    }

    /// Fills `bytes` from an offset; `what` describes the operation in messages.
    ///
    /// # Errors
    /// If the file cannot be read, or is too short.
    pub fn read_at(&self, what: &str, bytes: &mut [u8], offset: u64) -> Result<()> {
        self.file.read_exact_at(bytes, offset).map_err(|e| self.error(what, e))
    }

    /// The error of an operation on the file.
    pub fn error(&self, what: &str, cause: io::Error) -> Error {
        Error::io(what, cause).of_input(&self.name)
    }
}

//! The size, time and content of a file, by which a later run knows whether it is still the same.

use std::fs::{self, File, Metadata};
use std::io::{self, Read};
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use super::row::Row;
use data_encoding::HEXLOWER;
use sha2::{Digest, Sha256};

const BUFFER_LEN: usize = 1 << 16;

/// The size, time and content of a file. Rows hold it in three columns: what is before `_bytes`, `_modified`
/// and `_sha256` is a prefix.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileState {
    pub(super) bytes: u64,
    /// Time of the last change: seconds since 1970 with nine decimal places.
    pub(super) modified: String,
    /// SHA-256 of the content, as `sha256sum` prints it.
    pub(super) sha256: String,
}

impl FileState {
    /// Reads a file. `None` if it is not a regular one.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn of(path: &Path) -> io::Result<Option<FileState>> {
        // Before the content: what changes while it is read has another time later. Before it is opened: a
        // pipe can be opened once only.
        let metadata = fs::metadata(path)?;
        if !metadata.is_file() {
            return Ok(None);
        }
        let (digest, bytes) = digest_of(path)?;
        Ok(Some(FileState { bytes, modified: modified_of(&metadata), sha256: HEXLOWER.encode(&digest) }))
    }

    /// The state that a row holds; `None` if it holds none.
    pub(super) fn of_row(row: &Row, prefix: &str) -> Option<FileState> {
        let get = |column| row.find(&format!("{prefix}_{column}"));
        let [modified, sha256] = [get("modified")?, get("sha256")?].map(str::to_string);
        Some(FileState { bytes: get("bytes")?.parse().ok()?, modified, sha256 })
    }

    /// Enters it into a row.
    pub(super) fn enter(&self, row: &mut Row, prefix: &str) {
        row.set(&format!("{prefix}_bytes"), self.bytes.to_string());
        row.set(&format!("{prefix}_modified"), &self.modified[..]);
        row.set(&format!("{prefix}_sha256"), &self.sha256[..]);
    }

    /// Whether a file is the same: it has the size, and the time or else the content.
    pub(super) fn is_still(&self, path: &Path) -> bool {
        let Ok(metadata) = fs::metadata(path) else { return false };
        let has_content = || digest_of(path).is_ok_and(|(now, _)| HEXLOWER.encode(&now) == self.sha256);
        metadata.is_file()
            && metadata.len() == self.bytes
            && (modified_of(&metadata) == self.modified || has_content())
    }

    /// Whether a file has the size and the time.
    pub(super) fn has_time_of(&self, path: &Path) -> bool {
        fs::metadata(path)
            .is_ok_and(|found| found.len() == self.bytes && modified_of(&found) == self.modified)
    }
}

/// The SHA-256 of a file, and the number of bytes that were read.
///
/// # Errors
/// If it cannot be read.
pub fn digest_of(path: &Path) -> io::Result<([u8; 32], u64)> {
    let (mut file, mut hash) = (File::open(path)?, Sha256::new());
    let (mut bytes, mut buffer) = (0, vec![0; BUFFER_LEN]);
    loop {
        let len = match file.read(&mut buffer) {
            Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
            other => other?,
        };
        if len == 0 {
            return Ok((hash.finalize().into(), bytes));
        }
        hash.update(&buffer[..len]);
        bytes += len as u64;
    }
}

/// Time of the last change: seconds since 1970 with nine decimal places.
pub fn modified_of(metadata: &Metadata) -> String {
    format!("{}.{:09}", metadata.mtime(), metadata.mtime_nsec())
}

/// A digest of the sizes and times of files, in any order; a file that is missing has none of them.
pub fn digest_of_times<'p>(paths: impl IntoIterator<Item = &'p Path>) -> String {
    let state = |path| {
        fs::metadata(path).map_or(String::new(), |found| format!("{} {}\n", found.len(), modified_of(&found)))
    };
    let mut states: Vec<String> = paths.into_iter().map(state).collect();
    states.sort_unstable();
    HEXLOWER.encode(&Sha256::digest(states.concat()))
}

//! What a sweep remembers of a file that it read, to tell later whether the file is still the same.

use std::fs::{self, File, Metadata};
use std::io::{self, Read};
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use data_encoding::HEXLOWER;
use sha2::{Digest, Sha256};

const BUFFER_LEN: usize = 1 << 16;

/// The size, time and content of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Input {
    pub(super) bytes: u64,
    /// Time of the last change: seconds since 1970 with nine decimal places.
    pub(super) modified: String,
    /// SHA-256 of the content, as `sha256sum` prints it.
    pub(super) sha256: String,
}

impl Input {
    /// Reads a file. `None` if it is not a regular one.
    pub(super) fn of(path: &Path) -> io::Result<Option<Input>> {
        // Before the content: what changes while it is read has another time later. Before it is opened: a
        // pipe can be opened once only.
        let metadata = fs::metadata(path)?;
        if !metadata.is_file() {
            return Ok(None);
        }
        let mut file = File::open(path)?;
        let mut hash = Sha256::new();
        let (mut bytes, mut buffer) = (0, vec![0; BUFFER_LEN]);
        loop {
            let len = match file.read(&mut buffer) {
                Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
                other => other?,
            };
            if len == 0 {
                break;
            }
            hash.update(&buffer[..len]);
            bytes += len as u64;
        }
        let sha256 = HEXLOWER.encode(&hash.finalize());
        Ok(Some(Input { bytes, modified: modified(&metadata), sha256 }))
    }

    /// Whether a file is the same: it has the size, and the time or else the content.
    pub(super) fn is_still(&self, path: &Path) -> bool {
        let Ok(metadata) = fs::metadata(path) else { return false };
        let has_content =
            || Input::of(path).is_ok_and(|now| now.is_some_and(|now| now.sha256 == self.sha256));
        metadata.is_file()
            && metadata.len() == self.bytes
            && (modified(&metadata) == self.modified || has_content())
    }
}

fn modified(metadata: &Metadata) -> String {
    format!("{}.{:09}", metadata.mtime(), metadata.mtime_nsec())
}

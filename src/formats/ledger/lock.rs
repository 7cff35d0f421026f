//! Locks keep two runs apart that would write the same files.

use std::fs::{File, OpenOptions};
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use rustix::fs::{FlockOperation, flock};
use rustix::io::Errno;
use spmesh_base::error::{Error, Result};

/// Held until it is dropped, or the process ends in any way. It leaves nothing behind.
#[derive(Debug)]
pub(super) struct Lock {
    _file: File,
}

/// Locks a file or folder. `None` for devices and pipes, and on file systems without locks.
pub(super) fn lock(path: &Path) -> Result<Option<Lock>> {
    let failed = |e| Error::io("locking it", e).of_input(path.display().to_string());
    if is_device(path) {
        return Ok(None);
    }
    let file = File::open(path).map_err(failed)?;
    let in_use = || {
        let message =
            "another sweep is writing here: wait until it ends, or give another --out-dir and --summary";
        Error::usage(message).of_input(path.display().to_string())
    };
    match flock(&file, FlockOperation::NonBlockingLockExclusive) {
        Ok(()) => {}
        Err(Errno::WOULDBLOCK) => return Err(in_use()),
        Err(_) => return Ok(None),
    }
    // Whoever replaces a file holds its lock: if it was replaced since it was opened, the other one goes on.
    let identity = |metadata: std::fs::Metadata| (metadata.dev(), metadata.ino());
    let is_there = std::fs::metadata(path).map(identity).ok() == file.metadata().map(identity).ok();
    if is_there { Ok(Some(Lock { _file: file })) } else { Err(in_use()) }
}

/// Locks a file that may not exist yet: then it is created, without content. `None` as for [`lock`].
pub(super) fn lock_or_create(path: &Path) -> Result<Option<Lock>> {
    // Opening a pipe and closing it would tell its reader that all is written.
    if is_device(path) {
        return Ok(None);
    }
    let created = OpenOptions::new().append(true).create(true).open(path);
    created.map_err(|e| Error::io("creating it", e).of_input(path.display().to_string()))?;
    lock(path)
}

fn is_device(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|it| !it.is_file() && !it.is_dir())
}

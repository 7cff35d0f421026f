//! What an earlier sweep has done, as its summary says, and whether its inputs are still the same; locks keep
//! two sweeps apart.

use std::collections::{HashMap, HashSet};
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, Read};
use std::os::unix::fs::MetadataExt;
use std::path::{Component, Path, PathBuf};

use super::row::{Format, Row};
use data_encoding::HEXLOWER;
use rustix::fs::{FlockOperation, flock};
use rustix::io::Errno;
use sha2::{Digest, Sha256};
use spmesh_base::error::{Error, Result};

/// The files that an earlier run has done, with their rows; files that failed are left out.
#[derive(Debug, Default)]
pub(super) struct Done {
    by_file: HashMap<String, DoneFile>,
}

#[derive(Debug, Default)]
pub(super) struct DoneFile {
    rows: Vec<Row>,
}

impl DoneFile {
    /// Outputs with their lengths in bytes.
    pub(super) fn outputs(&self) -> impl Iterator<Item = (PathBuf, u64)> {
        self.rows
            .iter()
            .filter_map(|row| Some((row.get("output").into(), row.get("output_bytes").parse().ok()?)))
    }

    /// The file as it was when it was read; `None` if that is unknown.
    pub(super) fn input(&self) -> Option<Input> {
        let row = self.rows.first()?;
        let [modified, sha256] = ["input_modified", "input_sha256"].map(|column| row.get(column).to_string());
        Some(Input { bytes: row.get("input_bytes").parse().ok()?, modified, sha256 })
    }
}

impl Done {
    /// Reads the summary of an earlier run; empty if there is none. An incomplete last line is ignored.
    pub(super) fn read(path: &Path) -> Result<Done> {
        let name = path.display();
        let text = match fs::read(path) {
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(Done::default()),
            other => other.map_err(|e| Error::io("reading the summary", e).of_input(name.to_string()))?,
        };
        let text = String::from_utf8_lossy(&text);
        let complete = text.rfind('\n').map_or("", |end| &text[..=end]);
        let format = Format::of(path);
        let Some(rows) = (if complete.is_empty() { Some("") } else { complete.strip_prefix(&format.head()) })
        else {
            let message = "not a summary of this version of tess3: its first line has other columns. Do the \
                           sweep without --resume, or give another --summary";
            return Err(Error::usage(message).of_input(name.to_string()));
        };
        let mut done = Done::default();
        for row in rows.lines().filter_map(|line| format.row(line)) {
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

    /// Names of all outputs, without one, two, ... of their extensions.
    pub(super) fn stems(&self) -> HashSet<PathBuf> {
        let outputs = self.by_file.values().flat_map(DoneFile::outputs);
        let stems = outputs.flat_map(|(output, _)| {
            std::iter::successors(Some(output.with_extension("")), |stem| {
                stem.extension().map(|_| stem.with_extension(""))
            })
        });
        stems.collect()
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
pub(super) fn is_inside(output: &Path) -> bool {
    output.components().all(|part| matches!(part, Component::Normal(_)))
}

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

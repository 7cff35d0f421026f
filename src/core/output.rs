//! The output of a tool: stdout, or a file that appears under its name only when it is complete.

use std::fs::{self, File};
use std::io::{self, BufWriter, IsTerminal, Seek, SeekFrom, Write};
use std::os::fd::{AsFd, AsRawFd};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

use rustix::fs::{AtFlags, CWD};
#[cfg(target_os = "linux")]
use rustix::fs::{Mode, OFlags};

use crate::error::{Error, Result};
use crate::system;

/// Bytes of the write buffer.
const BUFFER_LEN: usize = 1 << 18;

/// Permissions of a new file, narrowed by the umask of the process.
const FILE_MODE: u32 = 0o666;

/// Write-back to the disk starts after every so many bytes, so that the commit waits for few bytes only.
const WRITE_BACK_LEN: u64 = 8 << 20;

/// Prefix of the name of an incomplete file, if it needs a name.
const TEMPORARY_PREFIX: &str = ".spmesh-";

/// An output that leaves nothing behind unless it is committed.
///
/// Invariant: the final name exists only after [`Output::commit`]. The data go to an unnamed file
/// (`O_TMPFILE`) in the same folder, so that even a killed process leaves nothing behind. If the system has
/// no unnamed files, the data go to a temporary name, which is removed on every exit except a kill.
pub struct Output {
    name: String,
    sink: Sink,
    written: u64,
    /// End of the bytes of a file that the system has started to write to the disk.
    write_back_end: u64,
}

enum Sink {
    /// Stdout, a device or a named pipe: written in place.
    InPlace(BufWriter<File>),
    Unnamed {
        file: BufWriter<File>,
        target: PathBuf,
    },
    Named {
        file: BufWriter<tempfile::NamedTempFile>,
        target: PathBuf,
    },
}

impl Output {
    /// Opens stdout for `-`, otherwise a file that will get the name `path`. If `path` is a symbolic link,
    /// its target is replaced, and the link stays.
    ///
    /// # Errors
    /// Usage, if `binary` data would go to a terminal; I/O, if the folder cannot be written to.
    pub fn create(path: &Path, binary: bool) -> Result<Output> {
        if path == Path::new("-") {
            let stdout = io::stdout();
            if binary && stdout.is_terminal() {
                return Err(Error::usage(
                    "refusing to write binary data to a terminal: redirect it, pipe it, or use --output",
                ));
            }
            // Bypasses `Stdout`, whose line buffering would search binary data for line ends.
            let file = stdout.as_fd().try_clone_to_owned().map_err(|e| Error::io("opening stdout", e))?;
            let sink = Sink::InPlace(BufWriter::with_capacity(BUFFER_LEN, File::from(file)));
            return Ok(Output { name: "stdout".into(), sink, written: 0, write_back_end: 0 });
        }
        let name = path.display().to_string();
        let sink = create_file(path).map_err(|e| Error::io("creating the output", e).of_input(&name))?;
        Ok(Output { name, sink, written: 0, write_back_end: 0 })
    }

    /// Bytes written so far.
    #[must_use]
    pub fn bytes_written(&self) -> u64 {
        self.written
    }

    /// Flushes, waits until the data of a file are on the disk, and gives it its final name. An existing file
    /// of that name is replaced.
    ///
    /// # Errors
    /// If the last bytes cannot be written, or the file cannot get its name. Nothing is left behind then.
    pub fn commit(self) -> Result<()> {
        let committed = match self.sink {
            Sink::InPlace(mut file) => file.flush(),
            Sink::Unnamed { file, target } => commit_unnamed(file, &target),
            Sink::Named { file, target } => commit_named(file, &target),
        };
        committed.map_err(|e| Error::io("finishing the output", e).of_input(self.name))
    }

    /// The error with the name of the output in front.
    fn named(&self, error: io::Error) -> io::Error {
        io::Error::new(error.kind(), format!("{}: {error}", self.name))
    }

    /// Makes the system start to write the bytes since the last call to the disk.
    fn start_write_back(&mut self) {
        let file = match &self.sink {
            Sink::InPlace(_) => return,
            Sink::Unnamed { file, .. } => file.get_ref(),
            Sink::Named { file, .. } => file.get_ref().as_file(),
        };
        let flushed = self.written.saturating_sub(BUFFER_LEN as u64);
        system::start_write_back(file, self.write_back_end, flushed - self.write_back_end);
        self.write_back_end = flushed;
    }

    fn writer(&mut self) -> &mut dyn Write {
        match &mut self.sink {
            Sink::InPlace(file) | Sink::Unnamed { file, .. } => file,
            Sink::Named { file, .. } => file,
        }
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.writer().write(bytes).map_err(|e| self.named(e))?;
        self.written += written as u64;
        if self.written - self.write_back_end > WRITE_BACK_LEN {
            self.start_write_back();
        }
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer().flush().map_err(|e| self.named(e))
    }
}

impl Seek for Output {
    /// # Errors
    /// If the output is a pipe or a terminal.
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let sought = match &mut self.sink {
            Sink::InPlace(file) | Sink::Unnamed { file, .. } => file.seek(to),
            Sink::Named { file, .. } => file.seek(to),
        };
        sought.map_err(|e| self.named(e))
    }
}

fn create_file(path: &Path) -> io::Result<Sink> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    if fs::metadata(&target).is_ok_and(|metadata| !metadata.is_file()) {
        let file = fs::OpenOptions::new().write(true).open(target)?;
        return Ok(Sink::InPlace(BufWriter::with_capacity(BUFFER_LEN, file)));
    }
    if let Some(file) = open_unnamed(folder_of(&target)) {
        return Ok(Sink::Unnamed { file: BufWriter::with_capacity(BUFFER_LEN, file), target });
    }
    let mode = fs::Permissions::from_mode(FILE_MODE);
    let mut builder = tempfile::Builder::new();
    let file = builder.prefix(TEMPORARY_PREFIX).permissions(mode).tempfile_in(folder_of(&target))?;
    Ok(Sink::Named { file: BufWriter::with_capacity(BUFFER_LEN, file), target })
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// A file without a name that can get one later; `None` if the system or the file system does not support it.
#[cfg(target_os = "linux")]
fn open_unnamed(folder: &Path) -> Option<File> {
    let flags = OFlags::TMPFILE | OFlags::WRONLY | OFlags::CLOEXEC;
    let file = File::from(rustix::fs::open(folder, flags, Mode::from_raw_mode(FILE_MODE)).ok()?);
    // The file gets its name through /proc: check that it is mounted before the work begins.
    descriptor_path(&file).exists().then_some(file)
}

/// A file without a name that can get one later; `None` if the system or the file system does not support it.
#[cfg(not(target_os = "linux"))]
fn open_unnamed(_folder: &Path) -> Option<File> {
    None
}

fn descriptor_path(file: &File) -> PathBuf {
    PathBuf::from(format!("/proc/self/fd/{}", file.as_raw_fd()))
}

/// Links the unnamed file to its name. A link cannot replace an existing file; if there is one, the file is
/// linked to a temporary name, which is then renamed.
fn commit_unnamed(file: BufWriter<File>, target: &Path) -> io::Result<()> {
    let file = file.into_inner().map_err(|e| e.into_error())?;
    file.sync_all()?;
    match link(&file, target) {
        Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {
            let mut builder = tempfile::Builder::new();
            let linked =
                builder.prefix(TEMPORARY_PREFIX).make_in(folder_of(target), |name| link(&file, name))?;
            linked.into_temp_path().persist(target).map_err(|e| e.error)
        }
        other => other,
    }
}

fn link(file: &File, name: &Path) -> io::Result<()> {
    rustix::fs::linkat(CWD, descriptor_path(file), CWD, name, AtFlags::SYMLINK_FOLLOW)?;
    Ok(())
}

fn commit_named(file: BufWriter<tempfile::NamedTempFile>, target: &Path) -> io::Result<()> {
    let file = file.into_inner().map_err(|e| e.into_error())?;
    file.as_file().sync_all()?;
    file.persist(target).map(drop).map_err(|e| e.error)
}

//! Where a tool writes: stdout, or a file that appears under its name only when it is complete.

use std::ffi::CString;
use std::fs::{self, File};
use std::io::{self, BufWriter, IsTerminal, Write};
use std::os::fd::{AsFd, AsRawFd};
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

const BUFFER_LEN: usize = 1 << 18;

/// An output that is committed or was never there.
///
/// Invariant: the final name exists only after [`Output::commit`]. The data go to an unnamed file
/// (`O_TMPFILE`) in the same folder, so that even a killed process leaves nothing behind; where the file
/// system cannot do that, to a temporary name that is removed on every exit but a kill.
pub struct Output {
    name: String,
    sink: Sink,
}

enum Sink {
    /// Stdout, a device or a named pipe: written in place, there is nothing to rename.
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
    /// Opens stdout for `-`, otherwise a file that will get the name `path`.
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
            // Past the line buffering of `Stdout`, which would look for line ends in binary data.
            let file = stdout.as_fd().try_clone_to_owned().map_err(|e| Error::io("opening stdout", e))?;
            let sink = Sink::InPlace(BufWriter::with_capacity(BUFFER_LEN, File::from(file)));
            return Ok(Output { name: "stdout".into(), sink });
        }
        let name = path.display().to_string();
        let sink = create_file(path).map_err(|e| Error::io("creating the output", e).of_input(&name))?;
        Ok(Output { name, sink })
    }

    /// Flushes, and gives a file its final name, replacing one that has it.
    ///
    /// # Errors
    /// If the last bytes cannot be written or the name cannot be given; then nothing is left behind.
    pub fn commit(self) -> Result<()> {
        let committed = match self.sink {
            Sink::InPlace(mut file) => file.flush(),
            Sink::Unnamed { file, target } => commit_unnamed(file, &target),
            Sink::Named { file, target } => file.into_inner().map_err(|e| e.into_error()).and_then(|file| {
                let made = file.persist(&target).map_err(|e| e.error)?;
                give_default_mode(&made)
            }),
        };
        committed.map_err(|e| Error::io("finishing the output", e).of_input(self.name))
    }

    /// Puts the name of the output before the reason, for whoever prints the error.
    fn named(&self, error: io::Error) -> io::Error {
        io::Error::new(error.kind(), format!("{}: {error}", self.name))
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
        self.writer().write(bytes).map_err(|e| self.named(e))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer().flush().map_err(|e| self.named(e))
    }
}

fn create_file(target: &Path) -> io::Result<Sink> {
    if fs::metadata(target).is_ok_and(|metadata| !metadata.is_file()) {
        let file = fs::OpenOptions::new().write(true).open(target)?;
        return Ok(Sink::InPlace(BufWriter::with_capacity(BUFFER_LEN, file)));
    }
    let target = target.to_path_buf();
    match open_unnamed(folder_of(&target)) {
        Ok(file) => Ok(Sink::Unnamed { file: BufWriter::with_capacity(BUFFER_LEN, file), target }),
        Err(_) => {
            let file = tempfile::Builder::new().prefix(".spmesh-").tempfile_in(folder_of(&target))?;
            Ok(Sink::Named { file: BufWriter::with_capacity(BUFFER_LEN, file), target })
        }
    }
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn open_unnamed(folder: &Path) -> io::Result<File> {
    use std::os::unix::fs::OpenOptionsExt;
    fs::OpenOptions::new().write(true).custom_flags(libc::O_TMPFILE).mode(0o666).open(folder)
}

/// Links the unnamed file to a temporary name and renames that, because a link cannot replace a file.
fn commit_unnamed(file: BufWriter<File>, target: &Path) -> io::Result<()> {
    let file = file.into_inner().map_err(|e| e.into_error())?;
    let source = CString::new(format!("/proc/self/fd/{}", file.as_raw_fd()))?;
    let link = |name: &Path| {
        let name = CString::new(name.as_os_str().as_bytes())?;
        // SAFETY: both paths are NUL-terminated strings that outlive the call, which keeps neither.
        let status = unsafe {
            libc::linkat(
                libc::AT_FDCWD,
                source.as_ptr(),
                libc::AT_FDCWD,
                name.as_ptr(),
                libc::AT_SYMLINK_FOLLOW,
            )
        };
        if status == 0 { Ok(()) } else { Err(io::Error::last_os_error()) }
    };
    match link(target) {
        Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {
            let mut name = std::ffi::OsString::from(".spmesh-");
            name.push(std::process::id().to_string());
            name.push(target.file_name().unwrap_or_default());
            let temporary = folder_of(target).join(name);
            link(&temporary)?;
            fs::rename(&temporary, target).inspect_err(|_| drop(fs::remove_file(&temporary)))
        }
        other => other,
    }
}

/// A named temporary file is private; the output gets the mode that a plain file would have.
fn give_default_mode(file: &File) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(fs::Permissions::from_mode(0o644))
}

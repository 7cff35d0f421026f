//! The output of a tool: stdout, or a file that appears under its name only when it is complete.

use std::fs::{self, File, Metadata};
use std::io::{self, BufWriter, IsTerminal, Seek, SeekFrom, Write};
use std::os::fd::{AsFd, AsRawFd};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::{MetadataExt, OpenOptionsExt, PermissionsExt, fchown};
use std::path::{Path, PathBuf};

use rustix::fs::{AtFlags, CWD};
#[cfg(target_os = "linux")]
use rustix::fs::{Mode, OFlags};

use crate::error::{Error, ErrorKind, Result};
use crate::inputs::{self, Claim};
use crate::system;
use crate::temporary::{Name, own_prefix, without_path};
use crate::upstream;

/// Bytes of the write buffer.
const BUFFER_LEN: usize = 1 << 18;

/// Permissions of a new file, narrowed by the umask of the process.
const FILE_MODE: u32 = 0o666;

/// The permissions that a file passes on to the one that replaces it.
const PERMISSIONS: u32 = 0o777;

/// Symbolic links that are followed one after the other, as on Linux.
const LINKS_MAX: usize = 40;

/// Write-back to the disk starts after every so many bytes, so that the commit waits for few bytes only.
const WRITE_BACK_LEN: u64 = 8 << 20;

/// An output that leaves nothing behind unless it is committed.
///
/// Invariant: the final name exists only after [`Output::commit`]. The data go to an unnamed file
/// (`O_TMPFILE`) in the same folder, so that even a killed process leaves nothing behind. If the system has
/// no unnamed files, the data go to a temporary name, which is removed on every exit except a kill that
/// cannot be caught, if the program has called [`crate::temporary::remove_names_at_signals`]; after such a
/// kill, [`crate::temporary::remove_orphans`] removes it.
pub struct Output {
    name: String,
    /// Keeps inputs from its place until it is complete.
    _claim: Claim,
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
        /// Removes the file at a signal.
        _name: Name,
    },
}

impl Output {
    /// Opens stdout for `-`, otherwise a file that will get the name `path`. If `path` is a symbolic link,
    /// its target is created or replaced, and the link stays. A file that is replaced passes on its
    /// permissions, and its owner if the system allows that.
    ///
    /// Binary data on stdout are marked if the program fails ([`crate::upstream`]).
    ///
    /// # Errors
    /// Usage, if `binary` data would go to a terminal, or the file is an input of this run; I/O, if stdout is
    /// closed or the folder cannot be written to.
    pub fn create(path: &Path, binary: bool) -> Result<Output> {
        let _claim = Claim::new(path)?;
        if path == Path::new("-") {
            let stdout = open_stdout()?;
            if binary && stdout.is_terminal() {
                return Err(Error::usage(
                    "refusing to write binary data to a terminal: redirect it, pipe it, or use --output",
                ));
            }
            upstream::output_is_open(binary);
            // Bypasses `Stdout`, whose line buffering would search binary data for line ends.
            let file = stdout.as_fd().try_clone_to_owned().map_err(|e| Error::io("opening stdout", e))?;
            let sink = Sink::InPlace(BufWriter::with_capacity(BUFFER_LEN, File::from(file)));
            return Ok(Output { name: "stdout".into(), _claim, sink, written: 0, write_back_end: 0 });
        }
        upstream::output_is_open(false);
        let name = path.display().to_string();
        let sink = create_file(path).map_err(|e| Error::io("creating the output", e).of_input(&name))?;
        Ok(Output { name, _claim, sink, written: 0, write_back_end: 0 })
    }

    /// Bytes written so far.
    pub fn bytes_written(&self) -> u64 {
        self.written
    }

    /// Flushes, waits until the data of a file are on the disk, gives it its final name, and waits until that
    /// is on the disk too. An existing file of that name is replaced.
    ///
    /// # Errors
    /// If the last bytes cannot be written, or the file cannot get its name. Nothing is left behind then.
    pub fn commit(self) -> Result<()> {
        self.finish(true)
    }

    /// The same without waiting for the disk: for many small files that count only beside another one, which
    /// is committed after [`sync_files`].
    ///
    /// # Errors
    /// As [`Output::commit`].
    pub fn commit_unsynced(self) -> Result<()> {
        self.finish(false)
    }

    fn finish(self, is_synced: bool) -> Result<()> {
        let committed = match self.sink {
            Sink::InPlace(mut file) => file.flush(),
            Sink::Unnamed { file, target } => commit_unnamed(file, &target, is_synced),
            Sink::Named { file, target, _name } => commit_named(file, &target, is_synced),
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
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let sought = match &mut self.sink {
            Sink::InPlace(file) | Sink::Unnamed { file, .. } => file.seek(to),
            Sink::Named { file, .. } => file.seek(to),
        };
        sought.map_err(|e| self.named(e))
    }
}

/// Makes a folder for outputs, and the folders it is in, unless they exist.
///
/// # Errors
/// If the system refuses it.
pub fn create_folder(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder)
        .map_err(|e| Error::io("creating the folder", e).of_input(folder.display().to_string()))
}

/// Waits until all files of the file system of a folder are on the disk.
///
/// # Errors
/// If the system reports one.
pub fn sync_files(folder: &Path) -> Result<()> {
    #[cfg(target_os = "linux")]
    {
        let failed =
            |e: io::Error| Error::io("waiting for the disk", e).of_input(folder.display().to_string());
        rustix::fs::syncfs(File::open(folder).map_err(failed)?).map_err(|e| failed(e.into()))
    }
    #[cfg(not(target_os = "linux"))]
    {
        let _ = folder;
        rustix::fs::sync();
        Ok(())
    }
}

/// Removes a file of an earlier run, if it is there. `what` it is stands in messages.
///
/// # Errors
/// If the system refuses it; usage, if the file is an input of this run.
pub fn remove_earlier(path: &Path, what: &str) -> Result<()> {
    if !path.is_file() {
        return Ok(());
    }
    inputs::check_output(path)?;
    let failed = |e| Error::io(format!("removing {what} of an earlier run"), e);
    fs::remove_file(path).map_err(|e| failed(e).of_input(path.display().to_string()))
}

/// Stdout.
///
/// # Errors
/// If it was closed when the program started.
pub fn open_stdout() -> Result<io::Stdout> {
    let stdout = io::stdout();
    if system::was_closed(&stdout) {
        return Err(Error::new(ErrorKind::Io, "stdout is closed: redirect it to a file or a pipe"));
    }
    Ok(stdout)
}

fn create_file(path: &Path) -> io::Result<Sink> {
    let replaced = match fs::metadata(path) {
        Ok(found) if !found.is_file() => {
            let file = fs::OpenOptions::new().write(true).open(path)?;
            return Ok(Sink::InPlace(BufWriter::with_capacity(BUFFER_LEN, file)));
        }
        Ok(found) => Some(found),
        Err(e) if e.kind() == io::ErrorKind::NotFound => None,
        Err(e) => return Err(e),
    };
    let target = target_of(path);
    if !target.file_name().is_some_and(|name| target.as_os_str().as_bytes().ends_with(name.as_bytes())) {
        return Err(io::Error::new(io::ErrorKind::IsADirectory, "the path has no file name"));
    }
    if let Some(file) = open_unnamed(folder_of(&target)) {
        keep_permissions(&file, replaced.as_ref());
        return Ok(Sink::Unnamed { file: BufWriter::with_capacity(BUFFER_LEN, file), target });
    }
    create_named(target, replaced.as_ref())
}

/// A file with a temporary name beside its target.
fn create_named(target: PathBuf, replaced: Option<&Metadata>) -> io::Result<Sink> {
    let mode = replaced.map_or(FILE_MODE, |replaced| replaced.mode() & FILE_MODE);
    let (file, name) = with_temporary_name(&target, |path| {
        fs::OpenOptions::new().write(true).create_new(true).mode(mode).open(path)
    })?;
    keep_permissions(file.as_file(), replaced);
    Ok(Sink::Named { file: BufWriter::with_capacity(BUFFER_LEN, file), target, _name: name })
}

/// Makes a file with a temporary name beside its target. The name is known to the handler of signals before
/// the file exists, so that no moment is left in which a signal would leave it behind.
fn with_temporary_name<F>(
    target: &Path,
    mut make: impl FnMut(&Path) -> io::Result<F>,
) -> io::Result<(tempfile::NamedTempFile<F>, Name)> {
    let mut name = None;
    let mut builder = tempfile::Builder::new();
    let prefix = own_prefix();
    let file = builder.prefix(&prefix).make_in(folder_of(target), |path| {
        // The name of an earlier attempt belongs to another file.
        drop(name.take());
        name = Some(Name::new(path));
        make(path).inspect_err(|_| drop(name.take()))
    });
    let file = file.map_err(without_path)?;
    Ok((file, name.unwrap_or_else(|| Name::new(Path::new("")))))
}

/// Gives a file the owner and the permissions of the file that it will replace, as far as the system allows.
fn keep_permissions(file: &File, replaced: Option<&Metadata>) {
    let Some(replaced) = replaced else { return };
    if fchown(file, Some(replaced.uid()), Some(replaced.gid())).is_err() {
        let _ = fchown(file, None, Some(replaced.gid()));
    }
    // After the owner, whose change may clear permissions.
    let _ = file.set_permissions(fs::Permissions::from_mode(replaced.mode() & PERMISSIONS));
}

/// The file that `path` leads to through symbolic links, whether it exists or not.
pub(crate) fn target_of(path: &Path) -> PathBuf {
    if let Ok(target) = fs::canonicalize(path) {
        return target;
    }
    let mut target = path.to_path_buf();
    for _ in 0..LINKS_MAX {
        let Ok(next) = fs::read_link(&target) else { break };
        target = folder_of(&target).join(next);
    }
    target
}

pub(crate) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// A file without a name that can get one later; `None` if the system or the file system does not support it.
#[cfg(target_os = "linux")]
pub(crate) fn open_unnamed(folder: &Path) -> Option<File> {
    let flags = OFlags::TMPFILE | OFlags::WRONLY | OFlags::CLOEXEC;
    let file = File::from(rustix::fs::open(folder, flags, Mode::from_raw_mode(FILE_MODE)).ok()?);
    // The file gets its name through /proc: check that it is mounted before the work begins.
    descriptor_path(&file).exists().then_some(file)
}

/// A file without a name that can get one later; `None` if the system or the file system does not support it.
#[cfg(not(target_os = "linux"))]
pub(crate) fn open_unnamed(_folder: &Path) -> Option<File> {
    None
}

fn descriptor_path(file: &File) -> PathBuf {
    PathBuf::from(format!("/proc/self/fd/{}", file.as_raw_fd()))
}

/// Links the unnamed file to its name. A link cannot replace an existing file; if there is one, the file is
/// linked to a temporary name, which is then renamed.
fn commit_unnamed(file: BufWriter<File>, target: &Path, is_synced: bool) -> io::Result<()> {
    let file = file.into_inner().map_err(|e| e.into_error())?;
    if is_synced {
        file.sync_all()?;
    }
    match link(&file, target) {
        Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {
            let (linked, _name) = with_temporary_name(target, |name| link(&file, name))?;
            linked.into_temp_path().persist(target).map_err(|e| e.error)?;
        }
        other => other?,
    }
    if is_synced { sync_folder(folder_of(target)) } else { Ok(()) }
}

fn link(file: &File, name: &Path) -> io::Result<()> {
    rustix::fs::linkat(CWD, descriptor_path(file), CWD, name, AtFlags::SYMLINK_FOLLOW)?;
    Ok(())
}

fn commit_named(file: BufWriter<tempfile::NamedTempFile>, target: &Path, is_synced: bool) -> io::Result<()> {
    let file = file.into_inner().map_err(|e| e.into_error())?;
    if is_synced {
        file.as_file().sync_all()?;
    }
    file.persist(target).map_err(|e| e.error)?;
    if is_synced { sync_folder(folder_of(target)) } else { Ok(()) }
}

/// Waits until the names in a folder are on the disk. Folders that may not be read, and file systems without
/// this request, are left alone.
fn sync_folder(folder: &Path) -> io::Result<()> {
    let Ok(folder) = File::open(folder) else { return Ok(()) };
    match folder.sync_all() {
        Err(e) if matches!(e.kind(), io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported) => Ok(()),
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use std::io::{BufRead, BufReader};
    use std::os::unix::process::ExitStatusExt;
    use std::process::{Command, Stdio};

    use super::*;
    use crate::temporary::remove_names_at_signals;

    /// The folder of the child process, which is this program again.
    const FOLDER: &str = "SPMESH_TEST_INTERRUPTED_FOLDER";

    /// The child: it writes to a file with a temporary name, says so, and waits for its end.
    fn write_and_wait(folder: &Path) {
        take_signals();
        remove_names_at_signals();
        let sink = create_named(folder.join("mesh.spm"), None).unwrap();
        let mut output = Output {
            name: "mesh.spm".into(),
            _claim: Claim::new(folder).unwrap(),
            sink,
            written: 0,
            write_back_end: 0,
        };
        output.write_all(b"half").unwrap();
        output.flush().unwrap();
        println!("ready");
        let _ = io::stdin().read_line(&mut String::new());
        output.commit().unwrap();
    }

    /// Whoever starts the tests may ignore or block signals, as nohup does, and this child inherits that.
    fn take_signals() {
        let mut none = std::mem::MaybeUninit::<libc::sigset_t>::zeroed();
        // SAFETY: the pointers are valid for the calls, and no handler is set.
        unsafe {
            libc::sigemptyset(none.as_mut_ptr());
            libc::pthread_sigmask(libc::SIG_SETMASK, none.as_ptr(), std::ptr::null_mut());
            for signal in [libc::SIGINT, libc::SIGTERM, libc::SIGHUP] {
                libc::signal(signal, libc::SIG_DFL);
            }
        }
    }

    #[test]
    fn signals_remove_files_with_temporary_names() {
        if let Some(folder) = std::env::var_os(FOLDER) {
            return write_and_wait(Path::new(&folder));
        }
        for signal in [Some(libc::SIGINT), Some(libc::SIGTERM), Some(libc::SIGHUP), None] {
            let folder = tempfile::tempdir().unwrap();
            let mut child = Command::new(std::env::current_exe().unwrap());
            child.args([
                "--exact",
                "--nocapture",
                "output::tests::signals_remove_files_with_temporary_names",
            ]);
            child.env(FOLDER, folder.path()).stdin(Stdio::piped()).stdout(Stdio::piped());
            let mut child = child.spawn().unwrap();
            let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
            assert!(lines.any(|line| line.unwrap().ends_with("ready")));
            let names = || fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name());
            assert!(names().next().unwrap().to_string_lossy().starts_with(".spmesh-"));
            match signal {
                // SAFETY: the call takes integers.
                Some(signal) => drop(unsafe { libc::kill(child.id() as i32, signal) }),
                None => child.stdin.take().unwrap().write_all(b"go on\n").unwrap(),
            }
            // The output of the test program goes on to its end.
            lines.for_each(drop);
            assert_eq!(child.wait().unwrap().signal(), signal);
            assert_eq!(names().collect::<Vec<_>>(), if signal.is_some() { vec![] } else { vec!["mesh.spm"] });
        }
    }
}

//! Holds the place of an input's bytes, so that each pass can read them from the start.

use std::fs::File;
use std::io::{self, Cursor, Read, Seek, SeekFrom, Stdin};
use std::os::fd::AsFd;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::detect::{HEAD_LEN, Reader, read_head};
use crate::source::gzip::{Plain, Use};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::inputs;
use spmesh_base::system;
use spmesh_base::temporary::TemporaryFile;
use spmesh_base::upstream::Watched;

/// Name of an input in messages: its path, or stdin for "-".
pub fn name_of(path: &Path) -> String {
    if path.as_os_str() == "-" { "stdin".to_string() } else { path.display().to_string() }
}

/// The content of a file: its bytes, decompressed if it is compressed.
pub(crate) type Bytes = Plain<FileView>;

/// Bytes that can be read several times.
#[derive(Debug)]
pub(crate) struct Origin {
    place: Place,
    purpose: Use,
}

#[derive(Debug)]
pub(crate) enum Place {
    /// A regular file, opened anew by each pass, so that an input of many tiles needs only one descriptor at
    /// a time.
    Path(PathBuf),
    /// A file without a name: a spool, or standard input redirected from a file.
    Open(Arc<File>),
}

/// What of an input may be copied to a temporary file. An endless input would fill the disk.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Admitted {
    /// All of it, if it starts as a format that the reader reads.
    Formats(&'static Reader),
    /// This many bytes.
    First(u64),
    /// All of it.
    Everything,
}

/// Stdin.
///
/// # Errors
/// If it was closed when the program started: an empty input would hide that. Usage, if it is one of the
/// outputs.
pub fn open_stdin() -> Result<Watched<Stdin>> {
    let stdin = io::stdin();
    if system::was_closed(&stdin) {
        return Err(Error::new(ErrorKind::Io, "stdin is closed: give a file or pipe a stream in"));
    }
    inputs::note(Path::new("-"))?;
    Ok(Watched(stdin))
}

impl Origin {
    fn at(place: Place) -> Origin {
        Origin { place, purpose: Use::Passed }
    }

    /// The same bytes, for a program that holds what it reads of them, or passes it: see [`Plain::held`].
    pub(crate) fn of_use(self, purpose: Use) -> Origin {
        Origin { purpose, ..self }
    }

    /// The bytes of `path`; "-" is standard input. An input that cannot be read twice (a pipe, a terminal, a
    /// socket) is spooled to an unlinked temporary file in `temp_dir`, with a notice, as far as it is
    /// `admitted`.
    pub(crate) fn new(
        path: &Path,
        admitted: Admitted,
        temp_dir: &Path,
        notices: &mut Vec<String>,
    ) -> Result<Origin> {
        if path.as_os_str() == "-" {
            let stdin = open_stdin()?;
            return Origin::of_stdin(&stdin, admitted, temp_dir, notices).map_err(|e| e.of_input("stdin"));
        }
        let name = path.display().to_string();
        let mut open = || -> Result<Origin> {
            let file = inputs::open(path)?;
            if inputs::is_regular(&file) {
                return Ok(Origin::at(Place::Path(path.to_path_buf())));
            }
            spool_pipe(file, &name, admitted, temp_dir, notices)
        };
        open().map_err(|e| e.of_input(&name))
    }

    fn of_stdin(
        stdin: &Watched<Stdin>,
        admitted: Admitted,
        temp_dir: &Path,
        notices: &mut Vec<String>,
    ) -> Result<Origin> {
        let descriptor = stdin.as_fd().try_clone_to_owned().map_err(|e| Error::io("opening", e))?;
        let mut file = File::from(descriptor);
        inputs::check_type(&file)?;
        if inputs::is_regular(&file) && file.stream_position().is_ok_and(|position| position == 0) {
            return Ok(Origin::at(Place::Open(Arc::new(file))));
        }
        spool_pipe(Watched(file), "stdin", admitted, temp_dir, notices)
    }

    /// The content from its start, decompressed if necessary.
    pub(crate) fn plain(&self) -> Result<Bytes> {
        Plain::of_use(self.view()?, self.purpose).map_err(|e| Error::io("reading", e))
    }

    /// The decompressed content as a file, for formats that are not read sequentially. Messages call it
    /// `name`.
    pub(crate) fn unpacked(&self, name: &str, temp_dir: &Path, notices: &mut Vec<String>) -> Result<Origin> {
        let (file, size) = spool(self.plain()?, temp_dir)?;
        let place = temp_dir.display();
        notices.push(format!("{name}: decompressed {size} to an unlinked temporary file in {place}"));
        Ok(file)
    }

    /// Copies all bytes of `input` to an unlinked temporary file.
    pub(crate) fn spooled(input: impl Read, temp_dir: &Path) -> Result<Origin> {
        spool(input, temp_dir).map(|(file, _)| file)
    }

    /// The path of a regular file, beside which others may belong to it.
    pub(crate) fn path(&self) -> Option<&Path> {
        match &self.place {
            Place::Path(path) => Some(path),
            Place::Open(_) => None,
        }
    }

    /// A view of all bytes as stored, positioned at their start.
    pub(crate) fn view(&self) -> Result<FileView> {
        let file = match &self.place {
            Place::Path(path) => Arc::new(inputs::open(path)?),
            Place::Open(file) => Arc::clone(file),
        };
        let end = file.metadata().map_err(|e| Error::io("opening", e))?.len();
        Ok(FileView { file, position: 0, end })
    }
}

/// Spools a file that cannot be read twice, and adds a notice.
fn spool_pipe(
    mut from: impl Read,
    name: &str,
    admitted: Admitted,
    temp_dir: &Path,
    notices: &mut Vec<String>,
) -> Result<Origin> {
    let (file, size) = match admitted {
        Admitted::Everything => spool(from, temp_dir)?,
        Admitted::First(bytes) => spool(from.take(bytes), temp_dir)?,
        Admitted::Formats(reader) => {
            let head = read_head(&mut from).map_err(|e| Error::io("reading", e))?;
            reader.detect(&plain_start(&head))?;
            spool(Cursor::new(head).chain(from), temp_dir)?
        }
    };
    let place = temp_dir.display();
    notices
        .push(format!("{name}: spooled {size} to an unlinked temporary file in {place} for the second pass"));
    Ok(file)
}

/// What the first bytes of an input decompress to, as far as they go.
fn plain_start(head: &[u8]) -> Vec<u8> {
    let mut start = Vec::new();
    if let Ok(plain) = Plain::new(head) {
        // The head ends within compressed data: what came before the error counts.
        let _ = plain.take(HEAD_LEN).read_to_end(&mut start);
    }
    start
}

/// Copies all bytes of `input` to an unlinked temporary file; also returns their amount as text.
fn spool(mut input: impl Read, temp_dir: &Path) -> Result<(Origin, String)> {
    let file = TemporaryFile::create(Some(temp_dir))?;
    let mut buffer = vec![0; 1 << 17];
    let mut bytes = 0u64;
    loop {
        let len = match input.read(&mut buffer) {
            Ok(0) => break,
            Ok(len) => len,
            Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
            Err(e) => return Err(Error::io("reading", e)),
        };
        file.append("spooling to it", &buffer[..len])?;
        bytes += len as u64;
    }
    let size =
        if bytes < 1_000_000 { format!("{bytes} bytes") } else { format!("{:.1} MB", bytes as f64 / 1e6) };
    Ok((Origin::at(Place::Open(Arc::new(file.into_file()))), size))
}

/// A reader with a position of its own over a shared file, so that passes do not disturb each other.
#[derive(Debug, Clone)]
pub(crate) struct FileView {
    file: Arc<File>,
    position: u64,
    end: u64,
}

impl FileView {
    /// Length of the file in bytes.
    pub(crate) fn len(&self) -> u64 {
        self.end
    }

    /// Offset of the next byte, counted from the start of the file.
    pub(crate) fn position(&self) -> u64 {
        self.position
    }

    /// The same bytes from `start` up to `end`, both counted from the start of the file.
    pub(crate) fn range(&self, start: u64, end: u64) -> FileView {
        FileView { file: Arc::clone(&self.file), position: start, end: end.min(self.end) }
    }

    /// Fills `buffer` with the bytes from `start` on, without changing the position.
    pub(crate) fn read_at(&self, start: u64, buffer: &mut [u8]) -> io::Result<()> {
        self.range(start, self.end).read_exact(buffer)
    }
}

impl Read for FileView {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let left = usize::try_from(self.end.saturating_sub(self.position)).unwrap_or(usize::MAX);
        let wanted = buffer.len().min(left);
        let read = self.file.read_at(&mut buffer[..wanted], self.position)?;
        self.position += read as u64;
        Ok(read)
    }
}

impl Seek for FileView {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let target = match to {
            SeekFrom::Start(position) => Some(position),
            SeekFrom::Current(step) => self.position.checked_add_signed(step),
            SeekFrom::End(step) => self.end.checked_add_signed(step),
        };
        self.position = target.ok_or_else(|| io::Error::from(io::ErrorKind::InvalidInput))?;
        Ok(self.position)
    }
}

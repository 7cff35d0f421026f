//! The files that a run reads and writes. Whichever code opens a file, no output of the run replaces it.

use std::collections::HashMap;
use std::fs::{self, File};
use std::io::{IsTerminal, Read};
use std::os::unix::fs::{FileTypeExt, MetadataExt};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::error::{Error, Result};
use crate::limits;
use crate::places::{Place, name_of_input, name_of_output};

/// The files of a run, from [`watch`] on.
static RUN: Mutex<Option<Files>> = Mutex::new(None);

#[derive(Debug, Default)]
struct Files {
    /// Names of what was opened.
    inputs: HashMap<Place, String>,
    /// Names of outputs that are not complete yet.
    outputs: HashMap<Place, String>,
}

/// From now on, an output that would replace a file that this process has read, or reads later, is an error.
/// Programs call this at their start. A process of several runs may well replace what an earlier run has
/// read.
pub fn watch() {
    run().get_or_insert_default();
}

fn run() -> MutexGuard<'static, Option<Files>> {
    RUN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Opens a file for reading. All files that users name, and those found beside them, are opened here.
///
/// # Errors
/// If the file cannot be opened; usage, if it is a folder, a device, or one of the outputs.
pub fn open(path: &Path) -> Result<File> {
    let file = File::open(path).map_err(|e| Error::io("opening", e))?;
    check_type(&file)?;
    enter(path, Place::of_file(&file))?;
    Ok(file)
}

/// Whether a file that is open is a regular one.
pub fn is_regular(file: &File) -> bool {
    file.metadata().is_ok_and(|metadata| metadata.is_file())
}

/// Takes note of a file that a library opens by its path, or that another run needs.
///
/// # Errors
/// Usage, if it is one of the outputs.
pub fn note(path: &Path) -> Result<()> {
    enter(path, Place::of_input(path))
}

/// Opens the file beside `path` that has one of these endings, and returns its path, too.
///
/// # Errors
/// As [`open`], with the name of the file; none if there is no such file.
pub fn open_beside(path: &Path, endings: &[&str]) -> Result<Option<(File, PathBuf)>> {
    for ending in endings {
        let beside = path.with_extension(ending);
        if fs::symlink_metadata(&beside).is_ok() {
            let file = open(&beside).map_err(|e| e.of_input(beside.display().to_string()))?;
            return Ok(Some((file, beside)));
        }
    }
    Ok(None)
}

/// The content of a file that must not be longer than `most`. `subject` is what messages say of it, such as
/// "a plan of".
///
/// # Errors
/// As [`open`]; malformed, if the file is longer.
pub fn read(path: &Path, subject: &str, most: u64) -> Result<Vec<u8>> {
    let file = open(path)?;
    limits::check_len(subject, file.metadata().map_err(|e| Error::io("reading", e))?.len(), most)?;
    // A pipe or a file of /proc says nothing of its length.
    content(file, most)?.ok_or_else(|| Error::malformed(format!("{subject} more than {most} bytes")))
}

/// The content of a file; `None` if it is longer than `most`.
///
/// # Errors
/// I/O, if reading fails.
pub fn content(file: File, most: u64) -> Result<Option<Vec<u8>>> {
    let mut content = Vec::new();
    file.take(most + 1).read_to_end(&mut content).map_err(|e| Error::io("reading", e))?;
    Ok(Some(content).filter(|content| content.len() as u64 <= most))
}

/// Refuses what is not read as a file: folders, and devices other than a terminal and /dev/null, which may be
/// endless.
pub fn check_type(file: &File) -> Result<()> {
    let metadata = file.metadata().map_err(|e| Error::io("opening", e))?;
    let kind = metadata.file_type();
    if kind.is_dir() {
        return Err(Error::usage("is a folder, expected a file"));
    }
    let is_null = || fs::metadata("/dev/null").is_ok_and(|null| null.rdev() == metadata.rdev());
    if kind.is_char_device() && !file.is_terminal() && !is_null() {
        return Err(Error::usage("is a device, expected a file or a pipe"));
    }
    Ok(())
}

fn enter(path: &Path, place: Option<Place>) -> Result<()> {
    let (mut run, name) = (run(), name_of_input(path));
    let (Some(files), Some(place)) = (run.as_mut(), place) else { return Ok(()) };
    if let Some(output) = files.outputs.get(&place) {
        return Err(would_replace(output, &name));
    }
    files.inputs.insert(place, name);
    Ok(())
}

/// Refuses an output, or a file to be removed, that this run reads.
///
/// # Errors
/// Usage, with the name of the input.
pub fn check_output(path: &Path) -> Result<()> {
    check_place(path, Place::of_output(path).as_ref())
}

fn check_place(path: &Path, place: Option<&Place>) -> Result<()> {
    match place.and_then(|place| run().as_ref()?.inputs.get(place).cloned()) {
        Some(input) => Err(would_replace(&name_of_output(path), &input)),
        None => Ok(()),
    }
}

fn would_replace(output: &str, input: &str) -> Error {
    let message = format!("the output would replace the input {input}: give it another name");
    Error::usage(message).of_input(output)
}

/// An output until it is complete: nothing may be read from its place.
#[derive(Debug)]
pub(crate) struct Claim(Option<Place>);

impl Claim {
    /// # Errors
    /// As [`check_output`].
    pub(crate) fn new(path: &Path) -> Result<Claim> {
        let place = Place::of_output(path);
        check_place(path, place.as_ref())?;
        if let (Some(files), Some(place)) = (run().as_mut(), &place) {
            files.outputs.insert(place.clone(), name_of_output(path));
        }
        Ok(Claim(place))
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        if let (Some(files), Some(place)) = (run().as_mut(), &self.0) {
            files.outputs.remove(place);
        }
    }
}

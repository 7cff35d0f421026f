//! Recognizes outputs that would replace inputs or each other, however their paths are written.

use std::collections::{HashMap, HashSet};
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io;
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use rustix::fs::{FileType, fstat, stat};

use crate::error::{Error, Result};
use crate::output::{folder_of, target_of};

/// The identity of a file.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) enum Place {
    /// A regular file: device and inode.
    File(u64, u64),
    /// A file that does not exist yet: its path, free of symbolic links.
    New(PathBuf),
}

impl Place {
    /// The place of `path`, or of `standard` for "-". `None` for devices, which may be given several times,
    /// for pipes (see [`pipe_at`]), for folders, and for paths that cannot be created.
    fn of(path: &Path, standard: BorrowedFd<'_>) -> Option<Place> {
        match found_at(path, standard) {
            Ok(found) => {
                (found.kind == FileType::RegularFile).then_some(Place::File(found.device, found.inode))
            }
            Err(_) if is_standard(path) => None,
            Err(_) => {
                let target = target_of(path);
                let folder = fs::canonicalize(folder_of(&target)).ok()?;
                Some(Place::New(folder.join(target.file_name()?)))
            }
        }
    }

    /// The place of an input, which may name a layer of a file.
    pub(crate) fn of_input(path: &Path) -> Option<Place> {
        Place::of(file_and_layer(path).0, io::stdin().as_fd())
    }

    pub(crate) fn of_output(path: &Path) -> Option<Place> {
        Place::of(path, io::stdout().as_fd())
    }

    /// The place of an open file, if it is a regular one.
    pub(crate) fn of_file(file: &File) -> Option<Place> {
        let metadata = file.metadata().ok().filter(fs::Metadata::is_file)?;
        Some(Place::File(metadata.dev(), metadata.ino()))
    }
}

/// Whether `path` is that of a device, such as /dev/fd/3.png, whose ending stands for no format. /dev/shm is
/// a folder of files.
pub fn is_device(path: &Path) -> bool {
    path.starts_with("/dev") && !path.starts_with("/dev/shm")
}

/// The file at a path, and the layer of it that the path names: `map.gpkg:rivers` is the layer `rivers` of
/// `map.gpkg`, unless a file has this whole name.
pub fn file_and_layer(path: &Path) -> (&Path, Option<String>) {
    let bytes = path.as_os_str().as_bytes();
    let colons = (0..bytes.len()).filter(|&at| bytes[at] == b':');
    let mut parts = colons.map(|at| (Path::new(OsStr::from_bytes(&bytes[..at])), &bytes[at + 1..]));
    match parts.find(|(file, _)| file.is_file() && !path.exists()) {
        Some((file, layer)) => (file, Some(String::from_utf8_lossy(layer).into_owned())),
        None => (path, None),
    }
}

/// The files that a run reads.
#[derive(Debug, Clone, Default)]
pub struct Inputs {
    names: HashMap<Place, String>,
}

impl Inputs {
    /// The files at these paths; "-" is stdin.
    pub fn of<'p>(paths: impl IntoIterator<Item = &'p Path>) -> Inputs {
        let place = |path: &'p Path| Some((Place::of_input(path)?, name_of_input(path)));
        Inputs { names: paths.into_iter().filter_map(place).collect() }
    }

    /// The name of the input that an output at `path` would replace, if there is one; "-" is stdout.
    pub fn at(&self, path: &Path) -> Option<&str> {
        let place = Place::of_output(path)?;
        self.names.get(&place).map(String::as_str)
    }
}

/// Checks that all outputs of a run are different from its inputs and from each other, and that no pipe is
/// two inputs. An output comes with the flag that names it; "-" is stdin or stdout.
///
/// # Errors
/// Usage, if two of them are one file, two outputs are stdout, or two inputs are one pipe.
pub fn check_apart<'p>(inputs: impl IntoIterator<Item = &'p Path>, outputs: &[(&str, &Path)]) -> Result<()> {
    let inputs: Vec<&Path> = inputs.into_iter().collect();
    check_pipes(inputs.iter().copied())?;
    let inputs = Inputs::of(inputs);
    for &(flag, path) in outputs {
        if let Some(input) = inputs.at(path) {
            let message = format!("{flag} would replace the input {input}: give it another name");
            return Err(Error::usage(message).of_input(name_of_output(path)));
        }
    }
    let mut flags: HashMap<Mixed, &str> = HashMap::new();
    for &(flag, path) in outputs {
        for place in Mixed::all_of(path) {
            if let Some(other_flag) = flags.insert(place, flag) {
                let message =
                    format!("{other_flag} and {flag} would be mixed: give one of them another file");
                return Err(Error::usage(message).of_input(name_of_output(path)));
            }
        }
    }
    Ok(())
}

/// What two outputs must not have in common.
#[derive(Debug, PartialEq, Eq, Hash)]
enum Mixed {
    Stdout,
    File(Place),
    Pipe(u64, u64),
}

impl Mixed {
    fn all_of(path: &Path) -> impl Iterator<Item = Mixed> {
        let stdout = is_standard(path).then_some(Mixed::Stdout);
        let pipe = pipe_at(path, io::stdout().as_fd()).map(|(device, inode)| Mixed::Pipe(device, inode));
        [stdout, Place::of_output(path).map(Mixed::File), pipe].into_iter().flatten()
    }
}

/// Refuses a named pipe that is given as two inputs: its data can be read once, and the second time the
/// program would wait for a writer that never comes. Programs say themselves what "-" may stand for.
///
/// # Errors
/// Usage, with the name of the pipe.
pub fn check_pipes<'p>(inputs: impl IntoIterator<Item = &'p Path>) -> Result<()> {
    let mut pipes = HashSet::new();
    for path in inputs {
        let Some(pipe) = pipe_at(path, io::stdin().as_fd()) else { continue };
        if !pipes.insert(pipe) && !is_standard(path) {
            let message = "is a pipe that is given twice, but its data can be read once: give a file";
            return Err(Error::usage(message).of_input(name_of_input(path)));
        }
    }
    Ok(())
}

fn is_standard(path: &Path) -> bool {
    path == Path::new("-")
}

pub(crate) fn name_of_input(path: &Path) -> String {
    name_of(path, "stdin")
}

pub(crate) fn name_of_output(path: &Path) -> String {
    name_of(path, "stdout")
}

/// The path, or the name of the standard stream that "-" stands for.
fn name_of(path: &Path, standard: &str) -> String {
    if is_standard(path) { standard.to_string() } else { path.display().to_string() }
}

/// The device and inode of a pipe.
fn pipe_at(path: &Path, standard: BorrowedFd<'_>) -> Option<(u64, u64)> {
    let found = found_at(path, standard).ok()?;
    (found.kind == FileType::Fifo).then_some((found.device, found.inode))
}

/// What is at a path.
struct Found {
    kind: FileType,
    device: u64,
    inode: u64,
}

/// What is at `path`, or is `standard` for "-". Opens no file: a process may have no further descriptor.
fn found_at(path: &Path, standard: BorrowedFd<'_>) -> rustix::io::Result<Found> {
    let status = if is_standard(path) { fstat(standard)? } else { stat(path)? };
    // The types of these numbers depend on the system.
    #[allow(clippy::unnecessary_cast)]
    let (device, inode) = (status.st_dev as u64, status.st_ino as u64);
    Ok(Found { kind: FileType::from_raw_mode(status.st_mode), device, inode })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;
    use std::process::Command;

    fn check(inputs: &[PathBuf], outputs: &[PathBuf]) -> Result<()> {
        let outputs: Vec<_> = ["--one", "--two", "--three"].into_iter().zip(outputs).collect();
        let outputs: Vec<_> = outputs.iter().map(|(flag, path)| (*flag, path.as_path())).collect();
        check_apart(inputs.iter().map(PathBuf::as_path), &outputs)
    }

    #[test]
    fn one_file_is_recognized_by_all_its_names() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::create_dir(path("sub")).unwrap();
        fs::write(path("a"), "a").unwrap();
        fs::hard_link(path("a"), path("hard")).unwrap();
        symlink("a", path("soft")).unwrap();
        symlink("new", path("dangling")).unwrap();
        let old = [("a", "hard"), ("a", "soft"), ("a", "sub/../a")];
        let new = [("new", "dangling"), ("new", "sub/../new")];
        for (a, b) in old.into_iter().chain(new) {
            let error = check(&[], &[path(a), path(b)]).unwrap_err();
            let expected = format!("{}: --one and --two would be mixed", path(b).display());
            assert!(error.to_string().starts_with(&expected), "{error}");
        }
        for (a, b) in old {
            let error = check(&[path(a)], &[path("new"), path(b)]).unwrap_err();
            let expected = format!("--two would replace the input {}", path(a).display());
            assert!(error.to_string().contains(&expected), "{error}");
            assert_eq!(error.exit_code(), 2);
        }
    }

    #[test]
    fn devices_and_different_files_are_apart() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("a"), "a").unwrap();
        let null = PathBuf::from("/dev/null");
        let inputs = [null.clone(), path("a"), path("missing")];
        check(&inputs, &[null.clone(), null, path("b")]).unwrap();
        assert!(Command::new("mkfifo").arg(path("pipe")).status().unwrap().success());
        let pipe = path("pipe");
        check(&[pipe.clone(), path("a")], &[]).unwrap();
        symlink("pipe", path("soft")).unwrap();
        check(&[], &[pipe.clone(), path("b")]).unwrap();
        let error = check(&[], &[pipe.clone(), path("soft")]).unwrap_err();
        assert!(error.to_string().contains("--one and --two would be mixed"), "{error}");
        for twice in [pipe.clone(), path("soft")] {
            let error = check(&[pipe.clone(), path("a"), twice.clone()], &[]).unwrap_err();
            let expected = format!("{}: is a pipe that is given twice", twice.display());
            assert!(error.to_string().starts_with(&expected), "{error}");
        }
        let error = check(&[], &["-".into(), path("b"), "-".into()]).unwrap_err();
        assert!(error.to_string().starts_with("stdout: --one and --three would be mixed"), "{error}");
    }
}

//! The list of bad files that a mesh does without: behind a first line that says so, a line for each, with
//! tabs between its path, what is wrong with it, its length, and when it was last changed. Of a file that was
//! not there, these are `-`.
//!
//! A file that has changed since it was listed counts as mended. So a tile that is delivered again is read
//! again, with no change to the list.

use std::collections::{BTreeMap, HashSet};
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::files::state_of;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::REPORT_LEN_MAX;
use spmesh_base::output::Output;
use spmesh_formats::source::SkippedFile;

/// Bad files by their absolute paths.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SkipList {
    files: BTreeMap<PathBuf, Bad>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
struct Bad {
    reason: String,
    state: State,
}

/// What a file was when it was listed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// Nobody has looked: the line was written by hand.
    Unknown,
    /// There was no such file.
    Missing,
    /// Its length and time.
    There(u64, i64),
}

impl State {
    fn of(path: &Path) -> State {
        state_of(path).map_or(State::Missing, |(bytes, modified)| State::There(bytes, modified))
    }
}

/// The first line of a list: no other file is taken for one, and replaced.
const HEAD: &str = "# bad files: path, reason, length, time";

impl SkipList {
    /// Reads a list; that of a file which does not exist is empty. The same file is written in the end, so it
    /// does not count as an input that must stay.
    ///
    /// # Errors
    /// I/O, if the file cannot be read; malformed, if it is no such list.
    pub fn read(path: &Path) -> Result<SkipList> {
        let named = |error: Error| error.of_input(path.display().to_string());
        match fs::metadata(path) {
            Err(e) if e.kind() == ErrorKind::NotFound => return Ok(SkipList::default()),
            Ok(found) if !found.is_file() || found.len() > REPORT_LEN_MAX => {
                return Err(named(Error::malformed("this is no list of bad files")));
            }
            _ => {}
        }
        let text = fs::read(path).map_err(|e| named(Error::io("reading", e)))?;
        let text = String::from_utf8(text).map_err(|_| named(Error::malformed("this is not UTF-8")))?;
        let mut list = SkipList::default();
        if !text.is_empty() && text.lines().next() != Some(HEAD) {
            let message = format!("this is no list of bad files, which begins with the line \"{HEAD}\"");
            return Err(named(Error::malformed(message)));
        }
        let lines = (1..).zip(text.lines()).skip(1);
        for (number, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
            let entry = parse(line).map_err(|e| named(e.at(format!("line {number}"))))?;
            list.files.extend([entry]);
        }
        Ok(list)
    }

    /// Whether a file is listed, and has not changed since.
    pub fn has(&self, path: &Path) -> bool {
        let bad = std::path::absolute(path).ok().and_then(|absolute| self.files.get(&absolute));
        bad.is_some_and(|bad| bad.state == State::Unknown || bad.state == State::of(path))
    }

    /// Lists a file, or what is known of it now.
    ///
    /// # Errors
    /// I/O, if the folder of the process is gone; usage, if the list cannot hold the name.
    pub fn add(&mut self, path: &Path, reason: &Error) -> Result<()> {
        let absolute = std::path::absolute(path).map_err(|e| Error::io("finding", e))?;
        let reason = reason.to_string().replace(|c: char| c.is_control(), " ");
        if absolute.to_str().is_none_or(|name| name.contains(char::is_control)) {
            let message =
                "its name is not UTF-8 or has control characters, which a list of bad files cannot hold";
            return Err(Error::usage(message).of_input(path.display().to_string()));
        }
        self.files.insert(absolute, Bad { reason, state: State::of(path) });
        Ok(())
    }

    /// Forgets files that are good again, and notes how the others are now.
    pub fn settle(&mut self, good: &[PathBuf]) {
        for path in absolute(good) {
            self.files.remove(&path);
        }
        for (path, bad) in &mut self.files {
            if bad.state == State::Unknown {
                bad.state = State::of(path);
            }
        }
    }

    /// The files of the list that are not `given`: their names may be misspelt.
    pub fn unknown(&self, given: &[PathBuf]) -> Vec<&Path> {
        let given = absolute(given);
        self.files.keys().map(PathBuf::as_path).filter(|path| !given.contains(*path)).collect()
    }

    /// What manifests say of those of the files that were `given`.
    pub fn skipped(&self, given: &[PathBuf]) -> Vec<SkippedFile> {
        let given = absolute(given);
        let file = |path: &PathBuf| path.display().to_string();
        let files = self.files.iter().filter(|(path, _)| given.contains(*path));
        files.map(|(path, bad)| SkippedFile { file: file(path), reason: bad.reason.clone() }).collect()
    }

    /// Writes the list.
    ///
    /// # Errors
    /// I/O, if it cannot be written; usage, if it would replace an input.
    pub fn write(&self, path: &Path) -> Result<()> {
        let mut output = Output::create(path, false)?;
        let writing = |e| Error::io("writing the list of bad files", e);
        writeln!(output, "{HEAD}").map_err(writing)?;
        for (path, Bad { reason, state }) in &self.files {
            let state = match state {
                State::Unknown => String::new(),
                State::Missing => "\t-\t-".to_string(),
                State::There(bytes, modified) => format!("\t{bytes}\t{modified}"),
            };
            writeln!(output, "{}\t{reason}{state}", path.display()).map_err(writing)?;
        }
        output.commit()
    }
}

/// The absolute paths of files.
fn absolute(files: &[PathBuf]) -> HashSet<PathBuf> {
    files.iter().filter_map(|path| std::path::absolute(path).ok()).collect()
}

fn parse(line: &str) -> Result<(PathBuf, Bad)> {
    let fields: Vec<&str> = line.split('\t').collect();
    let none = || Error::malformed("expected a path, a reason, a length and a time, with tabs between them");
    let (path, reason, state) = match fields[..] {
        [path] => (path, "listed by hand", State::Unknown),
        [path, reason] => (path, reason, State::Unknown),
        [path, reason, "-", "-"] => (path, reason, State::Missing),
        [path, reason, bytes, modified] => {
            let state = bytes.parse().ok().zip(modified.parse().ok());
            let (bytes, modified) = state.ok_or_else(none)?;
            (path, reason, State::There(bytes, modified))
        }
        _ => return Err(none()),
    };
    let path = std::path::absolute(path).map_err(|e| Error::io("finding", e))?;
    Ok((path, Bad { reason: reason.to_string(), state }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_listed_file_is_read_again_when_it_has_changed() {
        let folder = tempfile::tempdir().unwrap();
        let [list, tile, other] = ["bad.tsv", "a b.laz", "other.laz"].map(|name| folder.path().join(name));
        fs::write(&tile, "bad").unwrap();
        fs::write(&other, "bad, too").unwrap();
        let mut bad = SkipList::read(&list).unwrap();
        bad.add(&tile, &Error::malformed("no\ttable\nhere")).unwrap();
        bad.write(&list).unwrap();
        // A line by hand.
        let text = fs::read_to_string(&list).unwrap() + &format!("{}\n", other.display());
        fs::write(&list, text).unwrap();
        let mut bad = SkipList::read(&list).unwrap();
        assert!(bad.has(&tile) && bad.has(&other) && !bad.has(&list));
        bad.settle(&[]);
        fs::write(&tile, "mended").unwrap();
        fs::write(&other, "mended").unwrap();
        assert!(!bad.has(&tile) && !bad.has(&other));
        bad.settle(&[tile]);
        assert_eq!(bad.skipped(&[list.clone(), other]).len(), 1);
        for wrong in ["a\tb\tc", "a\tb\tc\td", "a\tb\t1\t2\t3"] {
            fs::write(&list, format!("{HEAD}\n{wrong}\n")).unwrap();
            assert!(SkipList::read(&list).is_err(), "{wrong}");
        }
        fs::write(&list, "notes of somebody\n").unwrap();
        assert!(SkipList::read(&list).is_err());
    }

    #[test]
    fn a_file_that_was_not_there_is_read_when_it_comes() {
        let folder = tempfile::tempdir().unwrap();
        let [list, late] = ["bad.tsv", "late.laz"].map(|name| folder.path().join(name));
        let mut bad = SkipList::default();
        bad.add(&late, &Error::malformed("gone")).unwrap();
        bad.settle(&[]);
        bad.write(&list).unwrap();
        let mut bad = SkipList::read(&list).unwrap();
        assert!(bad.has(&late));
        fs::write(&late, "here").unwrap();
        assert!(!bad.has(&late));
        assert!(bad.add(&folder.path().join("a\tb"), &Error::malformed("bad")).is_err());
    }
}

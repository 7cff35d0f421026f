//! The list of bad files that a mesh does without: a line for each, with tabs between its path, what is wrong with it,
//! its length, and when it was last changed.
//!
//! A file that has changed since it was listed counts as mended. So a tile that is delivered again is read again, with
//! no change to the list.

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
    /// Length and time; none if the file is gone, or the line was written by hand.
    state: Option<(u64, i64)>,
}

impl SkipList {
    /// Reads a list; that of a file which does not exist is empty. The same file is written in the end, so it does not
    /// count as an input that must stay.
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
        for (number, line) in (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty()) {
            let entry = parse(line).map_err(|e| named(e.at(format!("line {number}"))))?;
            list.files.extend([entry]);
        }
        Ok(list)
    }

    /// Whether a file is listed, and has not changed since.
    pub fn has(&self, path: &Path) -> bool {
        let bad = std::path::absolute(path).ok().and_then(|absolute| self.files.get(&absolute));
        bad.is_some_and(|bad| bad.state.is_none() || bad.state == state_of(path).ok())
    }

    /// Lists a file, or what is known of it now.
    ///
    /// # Errors
    /// I/O, if the folder of the process is gone.
    pub fn add(&mut self, path: &Path, reason: &Error) -> Result<()> {
        let absolute = std::path::absolute(path).map_err(|e| Error::io("finding", e))?;
        let reason = reason.to_string().replace(|c: char| c.is_control(), " ");
        self.files.insert(absolute, Bad { reason, state: state_of(path).ok() });
        Ok(())
    }

    /// Forgets files that are good again, and notes how the others are now.
    pub fn settle(&mut self, good: &[PathBuf]) {
        for path in good.iter().filter_map(|path| std::path::absolute(path).ok()) {
            self.files.remove(&path);
        }
        for (path, bad) in &mut self.files {
            bad.state = bad.state.or_else(|| state_of(path).ok());
        }
    }

    /// What manifests say of those of the files that were `given`.
    pub fn skipped(&self, given: &[PathBuf]) -> Vec<SkippedFile> {
        let given: HashSet<PathBuf> =
            given.iter().filter_map(|path| std::path::absolute(path).ok()).collect();
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
        for (path, Bad { reason, state }) in &self.files {
            let state = state.map_or(String::new(), |(bytes, modified)| format!("\t{bytes}\t{modified}"));
            writeln!(output, "{}\t{reason}{state}", path.display())
                .map_err(|e| Error::io("writing the list of bad files", e))?;
        }
        output.commit()
    }
}

fn parse(line: &str) -> Result<(PathBuf, Bad)> {
    let fields: Vec<&str> = line.split('\t').collect();
    let none = || Error::malformed("expected a path, a reason, a length and a time, with tabs between them");
    let (path, reason, state) = match fields[..] {
        [path] => (path, "listed by hand", None),
        [path, reason] => (path, reason, None),
        [path, reason, bytes, modified] => {
            let state = bytes.parse().ok().zip(modified.parse().ok());
            (path, reason, Some(state.ok_or_else(none)?))
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
            fs::write(&list, wrong).unwrap();
            assert!(SkipList::read(&list).is_err(), "{wrong}");
        }
    }
}

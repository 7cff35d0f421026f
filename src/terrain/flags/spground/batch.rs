//! Many files with a summary. All of them are one set of points, so a file that is damaged is left out of it,
//! and what is done stays done only as long as no other file changes.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use super::plans::Around;
use super::{Finished, Flags, TOOL};
use crate::flags::names::ENDINGS;
use crate::flags::rewrite::{Rewriter, Rewriting, Stated, Written};
use crate::ground::{ClassCounts, Found};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_formats::detect::SPGROUND;
use spmesh_formats::ledger::{Columns, OUTPUT_TIME, digest_of_times};
use spmesh_formats::sink::ColumnKind::{Integer, Number, Text};
use spmesh_formats::source::{PointFile, name_of};
use spmesh_shell::{Common, value_name};

/// Writes the files that are not done yet to a folder.
///
/// # Errors
/// As [`Rewriting::run`].
pub(super) fn run(
    flags: &Flags,
    around: Option<&Around>,
    folder: &Path,
    files: Vec<PathBuf>,
    outputs: Vec<PathBuf>,
) -> Result<Finished> {
    if around.is_some() && flags.batch.keep_going {
        let text = "--keep-going leaves damaged tiles out, and all jobs of a plan must leave out the same: plan \
                    again with spfinalize --skip-bad";
        return Err(Error::usage(text));
    }
    let set = Set { flags, around, inputs: around.map_or(&files, |around| &around.inputs).clone() };
    let mut finished = Finished::default();
    let rewriting = Rewriting { flags: &flags.batch, folder, files, outputs, shared: None };
    let ended = rewriting.run(&set, |written| {
        finished.files += 1;
        finished.counts.add(&written.counts);
    })?;
    finished.found = ended.basis.map(|basis| basis.found.counts().clone());
    finished.failure = ended.failure;
    Ok(finished)
}

/// The points that classes depend on.
struct Set<'f> {
    flags: &'f Flags,
    around: Option<&'f Around>,
    inputs: Vec<PathBuf>,
}

/// What is ground, and the files that were left out, each with the reason until it is told.
struct Basis {
    found: Found,
    left_out: Mutex<HashMap<String, Error>>,
}

impl Set<'_> {
    /// The place of the file that is to blame for an error, if it is to be left out.
    fn to_leave_out(&self, inputs: &[PathBuf], error: &Error) -> Option<usize> {
        let is_damage = matches!(error.kind(), ErrorKind::Io | ErrorKind::Malformed | ErrorKind::Unsupported);
        if !self.flags.batch.keep_going || !is_damage || error.is_shortage() || inputs.len() == 1 {
            return None;
        }
        inputs.iter().position(|path| error.input() == Some(&name_of(path)))
    }
}

impl Rewriter for Set<'_> {
    const TOOL: &'static str = TOOL;
    const WORK: &'static str = "classifying";
    const COLUMNS: Columns = &[
        ("file", Text),
        ("output", Text),
        ("status", Text),
        ("exit_code", Integer),
        ("error", Text),
        ("warnings", Text),
        ("points", Integer),
        ("other", Integer),
        ("ground", Integer),
        ("low_noise", Integer),
        ("high_noise", Integer),
        ("kept", Integer),
        ("seconds", Number),
        ("output_bytes", Integer),
        (OUTPUT_TIME, Text),
        ("options", Text),
        ("version", Text),
        ("input_bytes", Integer),
        ("input_modified", Text),
        ("input_sha256", Text),
    ];
    type Basis = Basis;
    type Counts = ClassCounts;

    fn common(&self) -> &Common {
        &self.flags.common
    }

    fn options_text(&self) -> Result<String> {
        let Flags { points, format, text, .. } = self.flags;
        let format = format.map_or("as the input", |format| value_name(ENDINGS, &format));
        let parameters = self.flags.parameters_json();
        let set = digest_of_times(self.inputs.iter().map(PathBuf::as_path));
        Ok(format!("{parameters} {points:?} format {format}{text} set {set}"))
    }

    fn open(&self, input: &Path, output: &Path) -> Result<PointFile> {
        let flags = self.flags;
        let file = PointFile::open(input, &SPGROUND, flags.temp_dir.get(), &flags.text.options())?;
        flags.names().check(&file, output).map(|()| file)
    }

    fn basis(&self, _: &[Stated], failed: &[&Path], _: &[PathBuf]) -> Result<Basis> {
        let is_whole = |path: &&PathBuf| !failed.contains(&&***path);
        let mut inputs: Vec<PathBuf> = self.inputs.iter().filter(is_whole).cloned().collect();
        let mut left_out = HashMap::new();
        loop {
            match self.flags.found(self.around, &inputs) {
                Ok((_, found)) => return Ok(Basis { found, left_out: Mutex::new(left_out) }),
                // What was read of it counts no more: classes are those of a run without it.
                Err(error) => match self.to_leave_out(&inputs, &error) {
                    Some(at) => left_out.insert(name_of(&inputs.remove(at)), error),
                    None => return Err(error),
                },
            };
        }
    }

    fn write(&self, basis: &Basis, file: &PointFile, output: &Path) -> Result<Written<ClassCounts>> {
        let mut left_out = basis.left_out.lock().unwrap_or_else(PoisonError::into_inner);
        left_out.remove(file.name()).map_or(Ok(()), Err)?;
        self.flags.rewrite(&basis.found, file, output)
    }

    fn fields(counts: &ClassCounts) -> Vec<(&'static str, u64)> {
        let [other, ground, low, high] = counts.classes;
        vec![
            ("points", counts.points),
            ("other", other),
            ("ground", ground),
            ("low_noise", low),
            ("high_noise", high),
            ("kept", counts.kept),
        ]
    }
}

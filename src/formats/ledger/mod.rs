//! The ledger of a batch: which files are done, by which inputs and options, in a summary that grows with
//! each file. A later run reads it, and does what is new, changed or failed alone.
//!
//! [`Ledger::open`] locks the folder and the summary and reads what was done; [`Ledger::left_to_do`] says
//! which files are left; [`Ledger::start`] begins the new summary, and [`Running::run`] does the work.

mod done;
mod lock;
mod row;
mod run;
mod state;
mod summary;

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

pub use done::DoneFile;
pub use row::{Columns, Row};
pub use run::{Attempt, News, Outcome, Running, attempt, contained};
pub use state::{FileState, digest_of, digest_of_times, modified_of};

use done::Done;
use lock::Lock;
use spmesh_base::error::{Error, Result};
use spmesh_base::inputs;
use spmesh_base::output::{Output, create_folder};
use spmesh_base::places::{Inputs, check_apart};
use summary::Summary;

/// A column that a summary may have: when the output was last changed. Where it is, a file whose output was
/// changed since is done again.
pub const OUTPUT_TIME: &str = "output_modified";

/// Files, each of which becomes outputs in a folder and rows of a summary.
///
/// The columns `file`, `output`, `output_bytes`, `options`, `error`, `version`, `seconds`, `input_bytes`,
/// `input_modified` and `input_sha256` must be there; others are the program's.
#[derive(Debug, Clone)]
pub struct Batch {
    /// The name of the program.
    pub program: &'static str,
    /// Its version; outputs that another one made are made again.
    pub version: String,
    /// The files, each of them once.
    pub files: Vec<PathBuf>,
    /// The file that lists them, if there is one; no output may replace it.
    pub list: Option<PathBuf>,
    /// A file that all outputs depend on, if there is one.
    pub shared: Option<SharedInput>,
    /// The options in words; outputs made with other options are made again.
    pub options: String,
    /// Folder of the outputs.
    pub folder: PathBuf,
    /// Where the summary goes; "-" is stdout. If its name ends in `.jsonl` or `.ndjson`, it is written as
    /// JSON Lines.
    pub summary: PathBuf,
    /// Where the summary goes as Parquet at the end, if anywhere.
    pub parquet: Option<PathBuf>,
    /// The columns of the summary.
    pub columns: Columns,
    /// Skip files that the summary lists as done, if they and their outputs are still the same.
    pub resume: bool,
    /// Stop at the first file that fails.
    pub strict: bool,
}

/// A file that all outputs of a batch depend on.
#[derive(Debug, Clone)]
pub struct SharedInput {
    /// Its path; "-" is stdin.
    pub path: PathBuf,
    /// What its columns start with: see [`FileState`].
    pub prefix: &'static str,
}

/// A file that is not done yet.
#[derive(Debug)]
pub struct Left<'b> {
    /// Its path.
    pub file: &'b Path,
    /// What an earlier run made of it.
    pub known: Option<DoneFile>,
}

/// A batch before its work.
#[derive(Debug)]
pub struct Ledger<'b> {
    batch: &'b Batch,
    /// What stays done.
    done: Done,
    /// What is done again in any case.
    earlier: Done,
    shared: Option<Shared<'b>>,
    /// The files that no output may replace.
    taken: Inputs,
    skipped: u64,
    folder_lock: Option<Lock>,
    summary_lock: Option<Lock>,
}

impl<'b> Ledger<'b> {
    /// Makes the folder, locks it and the summary, and reads what was done before.
    ///
    /// # Errors
    /// Usage, if a file is given twice, the summary would replace an input, or another run writes to the
    /// folder or the summary; if the folder cannot be written, or the summary to resume is malformed.
    pub fn open(batch: &'b Batch) -> Result<Ledger<'b>> {
        check_distinct(&batch.files)?;
        let inputs = || {
            let shared = batch.shared.as_ref().map(|shared| &shared.path);
            batch.files.iter().chain(&batch.list).chain(shared).map(PathBuf::as_path)
        };
        let summaries =
            std::iter::once(&batch.summary).chain(&batch.parquet).map(|path| ("--summary", &**path));
        check_apart(inputs(), &summaries.collect::<Vec<_>>())?;
        let shared = batch.shared.as_ref().map(|shared| Shared::new(shared, batch.resume)).transpose()?;
        create_folder(&batch.folder)?;
        let folder_lock = lock::lock(&batch.folder)?;
        // Devices and pipes have nothing of an earlier run.
        let existing = summary_file(batch).filter(|path| path.is_file());
        let summary_lock = existing.map_or(Ok(None), lock::lock)?;
        let found = existing.map_or_else(|| Ok(Done::default()), |path| Done::read(path, batch));
        // Unless the batch resumes, an earlier summary only says what is there, and any other file may be in
        // its place.
        let (done, earlier) = if batch.resume {
            (found?, Done::default())
        } else {
            (Done::default(), found.unwrap_or_default())
        };
        // Summaries are no inputs, but must not be replaced either.
        let taken = Inputs::of(inputs().chain(summary_file(batch)).chain(batch.parquet.as_deref()));
        Ok(Ledger { batch, done, earlier, shared, taken, skipped: 0, folder_lock, summary_lock })
    }

    /// The files that are not done yet; `skip` is called for the others. `is_whole` looks into an output of
    /// the right length. If files are left, the state of the shared file is noted, before anything reads it.
    ///
    /// # Errors
    /// If the shared file cannot be read.
    pub fn left_to_do(
        &mut self,
        is_whole: &dyn Fn(&Path) -> bool,
        skip: &mut dyn FnMut(),
    ) -> Result<Vec<Left<'b>>> {
        let batch = self.batch;
        let mut left = Vec::new();
        for file in batch.files.iter().map(PathBuf::as_path) {
            let found = self.done.file(file, &batch.options, &batch.version);
            let is_done = found.is_some_and(|found| {
                self.shared.as_mut().is_none_or(|shared| shared.is_still(found))
                    && found.is_still_there(file, &batch.folder, is_whole)
            });
            if is_done {
                self.skipped += 1;
                skip();
            } else {
                let known = self.done.take(file).or_else(|| self.earlier.take(file));
                left.push(Left { file, known });
            }
        }
        if !left.is_empty() {
            self.shared.iter_mut().try_for_each(Shared::read)?;
        }
        Ok(left)
    }

    /// Takes the outputs of files, relative to the folder. A file that is done under another of its names is
    /// forgotten.
    ///
    /// # Errors
    /// Usage, if an output is that of another file, which stays done.
    pub fn claim<'p>(&mut self, outputs: impl IntoIterator<Item = (&'p Path, &'p Path)>) -> Result<()> {
        let owner = |(file, output): (&Path, PathBuf)| (output, file.to_path_buf());
        let owners: HashMap<PathBuf, PathBuf> = self.done.outputs().map(owner).collect();
        for (file, output) in outputs {
            let Some(owner) = owners.get(output) else { continue };
            if !is_same_file(file, owner) {
                let [output, owner] = [output, owner].map(Path::display);
                let message = format!(
                    "its output {output} is that of {owner} in the summary: give another --out-dir and --summary"
                );
                return Err(Error::usage(message).of_input(file.display().to_string()));
            }
            self.done.take(owner);
        }
        Ok(())
    }

    /// The outputs that stay, relative to the folder, with the files that they were made of.
    pub fn outputs(&self) -> impl Iterator<Item = (&Path, PathBuf)> {
        self.done.outputs()
    }

    /// Checks that an output replaces none of the inputs, and not the summary.
    ///
    /// # Errors
    /// Usage, if it does.
    pub fn check_free(&self, output: &Path) -> Result<()> {
        check_free(output, &self.taken)
    }

    /// Begins the new summary with what stays done. Removes outputs of an earlier run that will be made
    /// again, so that none is stale, whenever the batch ends.
    ///
    /// # Errors
    /// If the folder or the summary cannot be written, or an output cannot be removed.
    pub fn start<'o>(self, stale: impl IntoIterator<Item = &'o Path>) -> Result<Running<'b>> {
        let Ledger { batch, done, shared, taken, skipped, folder_lock, mut summary_lock, .. } = self;
        // Fail before the work if outputs cannot be created in the folder.
        drop(Output::create(&batch.folder.join("output.spm"), true)?);
        if summary_lock.is_none() {
            summary_lock = summary_file(batch).map_or(Ok(None), lock::lock_or_create)?;
        }
        let parquet = batch.parquet.as_ref().map(|path| Output::create(path, true)).transpose()?;
        let shared = shared.and_then(|shared| Some((shared.input.prefix, shared.now?)));
        // Before the summary forgets them.
        stale.into_iter().try_for_each(|output| remove(&batch.folder.join(output), &taken))?;
        let summary = Summary::create(&batch.summary, batch.columns, &done)?;
        // The new summary has a lock of its own.
        drop(summary_lock);
        Ok(Running { batch, summary, parquet, shared, taken, skipped, _folder_lock: folder_lock })
    }
}

impl Batch {
    /// The row of a file that was tried: its name, the time, the state of the file and the error.
    pub fn row<T, N>(&self, file: &Path, attempt: &Attempt<T, N>) -> Row {
        let mut row = Row::new(self.columns);
        row.set("file", file.to_string_lossy());
        row.set("options", &self.options[..]);
        row.set("version", &self.version[..]);
        row.set("seconds", format!("{:.6}", attempt.time.as_secs_f64()));
        if let Some(state) = &attempt.input {
            state.enter(&mut row, "input");
        }
        if let Err(error) = &attempt.result {
            row.set("error", error.to_string());
        }
        row
    }
}

/// The summary, unless it goes to stdout.
fn summary_file(batch: &Batch) -> Option<&Path> {
    (batch.summary != Path::new("-")).then_some(&batch.summary)
}

/// Refuses a file that is given twice.
///
/// # Errors
/// Usage, with both of its names.
pub fn check_distinct(files: &[PathBuf]) -> Result<()> {
    let mut places: HashMap<PathBuf, &Path> = HashMap::new();
    for file in files {
        let place = if file == Path::new("-") { Ok(file.clone()) } else { std::path::absolute(file) };
        if let Some(other) = places.insert(place.unwrap_or_else(|_| file.clone()), file) {
            let also = if other == file { String::new() } else { format!(", also as {}", other.display()) };
            let message =
                format!("the file is given twice{also}: leave one out (sort -u removes equal lines)");
            return Err(Error::usage(message).of_input(file.display().to_string()));
        }
    }
    Ok(())
}

/// Whether two paths, which differ, are those of one file.
fn is_same_file(a: &Path, b: &Path) -> bool {
    let place = |path: &Path| path.canonicalize().or_else(|_| std::path::absolute(path)).ok();
    place(a).is_some_and(|a| Some(a) == place(b))
}

/// Checks that an output replaces none of the files that are `taken`.
///
/// # Errors
/// Usage, if it does.
pub fn check_free(output: &Path, taken: &Inputs) -> Result<()> {
    let Some(file) = taken.at(output) else { return Ok(()) };
    let message = format!("the output would replace {file}: give another --out-dir");
    Err(Error::usage(message).of_input(output.display().to_string()))
}

/// Removes a file, unless it is one of those that are `taken`, or does not exist.
fn remove(path: &Path, taken: &Inputs) -> Result<()> {
    if taken.at(path).is_some() || inputs::check_output(path).is_err() {
        return Ok(());
    }
    match fs::remove_file(path) {
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
            Err(Error::io("removing the output of an earlier run", e).of_input(path.display().to_string()))
        }
        _ => Ok(()),
    }
}

/// What is known of the file that all outputs depend on.
#[derive(Debug)]
struct Shared<'b> {
    input: &'b SharedInput,
    /// Its state, once a row had its time, or it was read.
    now: Option<FileState>,
}

impl<'b> Shared<'b> {
    fn new(input: &'b SharedInput, resume: bool) -> Result<Shared<'b>> {
        let path = &input.path;
        let is_pipe = path == Path::new("-") || path.exists() && !path.is_file();
        if resume && is_pipe {
            let message = "--resume compares it with that of the earlier run: give it as a file";
            return Err(Error::usage(message).of_input(path.display().to_string()));
        }
        Ok(Shared { input, now: None })
    }

    /// Whether it is as it was for an earlier output. Its content is read once, and only if its time differs.
    fn is_still(&mut self, done: &DoneFile) -> bool {
        let Some(then) = done.state(self.input.prefix) else { return false };
        if self.now.is_none() {
            let is_same = then.has_time_of(&self.input.path);
            self.now =
                if is_same { Some(then.clone()) } else { FileState::of(&self.input.path).ok().flatten() };
        }
        self.now.as_ref().is_some_and(|now| now.bytes == then.bytes && now.sha256 == then.sha256)
    }

    /// Notes its state, unless it is known or the file is no regular one.
    fn read(&mut self) -> Result<()> {
        let path = &self.input.path;
        if self.now.is_none() && path != Path::new("-") {
            let failed = |e| Error::io("reading", e).of_input(path.display().to_string());
            self.now = FileState::of(path).map_err(failed)?;
        }
        Ok(())
    }
}

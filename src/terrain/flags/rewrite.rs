//! Programs that write many files of points again, with a summary: what is done already is skipped, and a
//! file that fails need not end the others.

use std::fs::{self, Metadata};
use std::path::{Path, PathBuf};

use spmesh_base::error::{Error, Result, counted};
use spmesh_base::places::Inputs;
use spmesh_formats::ledger::{
    self, Attempt, Batch, Columns, Ledger, Left, News, OUTPUT_TIME, Outcome, Row, SharedInput, contained,
    modified_of,
};
use spmesh_formats::source::PointFile;
use spmesh_shell::batch::{BatchFlags, BatchMessages};
use spmesh_shell::{Common, notice};
use spmesh_stream::model::bounds::Bounds;

/// The name of the summary in the folder of outputs.
const SUMMARY_NAME: &str = "summary.jsonl";

/// The help of `--summary`, whose default is JSON Lines.
pub(super) const SUMMARY_HELP: &str = "Where the summary goes, a line per file: JSON Lines, a table if the name ends in \
    .tsv, or Parquet if it ends in .parquet; - is stdout [default: summary.jsonl in the folder, with --keep-going or --skip-existing]";

/// A program that writes files again, each for itself, by something that all of them need.
pub(super) trait Rewriter: Sync {
    /// Its name.
    const TOOL: &'static str;
    /// What it does with files, such as "finding heights".
    const WORK: &'static str;
    /// The columns of its summary, with those of [`Batch`], `status`, `exit_code`, `warnings` and its counts.
    /// Readers take them by name; new ones come last.
    const COLUMNS: Columns;
    /// What all files need.
    type Basis: Sync;
    /// What is counted of a file.
    type Counts: Send;

    /// Its flags.
    fn common(&self) -> &Common;

    /// The options that determine the content of the outputs, as text.
    fn options_text(&self) -> Result<String>;

    /// Opens a file, whose output gets this name.
    fn open(&self, input: &Path, output: &Path) -> Result<PointFile>;

    /// What all files need, once, if one is left. `failed` are files that cannot be opened.
    fn basis(&self, stated: &[Stated], failed: &[&Path], outputs: &[PathBuf]) -> Result<Self::Basis>;

    /// Writes a file.
    fn write(&self, basis: &Self::Basis, file: &PointFile, output: &Path) -> Result<Written<Self::Counts>>;

    /// Counts by their columns.
    fn fields(counts: &Self::Counts) -> Vec<(&'static str, u64)>;
}

/// What a header states of its points.
pub(super) struct Stated {
    pub(super) points: u64,
    pub(super) bounds: Option<Bounds>,
}

impl Stated {
    /// Texts state nothing, and streams need not.
    pub(super) fn by(file: &PointFile) -> Stated {
        match file {
            PointFile::Las(file) => Stated { points: file.points(), bounds: file.stated_bounds() },
            _ => Stated { points: u64::MAX, bounds: None },
        }
    }
}

/// A file that was written again.
pub(super) struct Written<C> {
    pub(super) counts: C,
    pub(super) bytes: u64,
    /// When it was last changed: see [`modified_of`].
    modified: String,
    pub(super) notices: Vec<String>,
}

impl<C> Written<C> {
    /// Looks at an output that has its name.
    ///
    /// # Errors
    /// I/O.
    pub(super) fn at(output: &Path, counts: C, notices: Vec<String>) -> Result<Written<C>> {
        let failed = |e| Error::io("looking at the output", e).of_input(output.display().to_string());
        // Fewer bytes than were written: the header is written twice.
        let found: Metadata = fs::metadata(output).map_err(failed)?;
        Ok(Written { counts, bytes: found.len(), modified: modified_of(&found), notices })
    }
}

/// Files, their outputs, and where these and the summary go.
pub(super) struct Rewriting<'f> {
    pub(super) flags: &'f BatchFlags,
    pub(super) folder: &'f Path,
    pub(super) files: Vec<PathBuf>,
    pub(super) outputs: Vec<PathBuf>,
    /// A file that all outputs depend on, if there is one.
    pub(super) shared: Option<SharedInput>,
}

/// A batch that has ended.
pub(super) struct Finished<B> {
    pub(super) outcome: Outcome,
    /// That of files failing.
    pub(super) failure: Option<Error>,
    /// What all files need, if one was left.
    pub(super) basis: Option<B>,
}

/// A file to write again.
struct Job<'f> {
    left: Left<'f>,
    /// Name of the output in the folder.
    output: PathBuf,
    /// The file, if it can be opened once only.
    kept: Option<PointFile>,
}

impl Rewriting<'_> {
    /// Writes the files that are not done yet; `sum` gets each that is.
    ///
    /// # Errors
    /// As [`Ledger::open`], [`Ledger::start`] and [`ledger::Running::run`], and those of the basis.
    pub(super) fn run<P: Rewriter>(
        self,
        program: &P,
        mut sum: impl FnMut(&Written<P::Counts>),
    ) -> Result<Finished<P::Basis>> {
        let paths = self.flags.summary_paths(self.folder, SUMMARY_NAME)?;
        let batch = Batch {
            program: P::TOOL,
            version: env!("CARGO_PKG_VERSION").to_string(),
            files: self.files,
            list: self.flags.lof.clone(),
            shared: self.shared,
            options: program.options_text()?,
            folder: self.folder.to_path_buf(),
            summary: paths.summary,
            parquet: paths.parquet,
            columns: P::COLUMNS,
            resume: self.flags.resume,
            strict: !self.flags.keep_going,
        };
        let mut ledger = Ledger::open(&batch)?;
        let mut messages = BatchMessages::new(P::TOOL, P::WORK, program.common());
        messages.hear(News::Files(batch.files.len() as u64));
        let left = ledger.left_to_do(&|_| true, &mut || messages.hear(News::Done))?;
        let mut jobs = jobs(left, &batch, &self.outputs);
        ledger.claim(jobs.iter().map(|job| (job.left.file, &*job.output)))?;
        let outputs: Vec<PathBuf> = jobs.iter().map(|job| self.folder.join(&job.output)).collect();
        outputs.iter().try_for_each(|output| ledger.check_free(output))?;
        let (stated, failed) = survey(program, &mut jobs, !batch.strict)?;
        let mut basis = None;
        if failed.len() < jobs.len() {
            basis = Some(program.basis(&stated, &failed, &outputs)?);
        }
        let earlier: Vec<PathBuf> =
            jobs.iter().filter_map(|job| job.left.known.as_ref()).flat_map(|known| known.outputs()).collect();
        let running = ledger.start(earlier.iter().map(PathBuf::as_path))?;
        let mut warned = 0;
        let rows = |job: &Job<'_>, end: &Attempt<Written<P::Counts>, ()>| {
            if let Ok(written) = &end.result {
                sum(written);
                warned += u64::from(!written.notices.is_empty());
            }
            vec![row::<P>(job, end, &batch)]
        };
        let work =
            |job: &Job<'_>, taken: &Inputs| attempt(program, basis.as_ref(), job, &batch.folder, taken);
        // One at a time: each is worked on by several threads.
        let outcome = running.run(1, &jobs, work, rows, &mut |news| messages.hear(news))?;
        let failure = messages.conclude(&outcome, &paths.shown);
        if warned > 0 {
            let have = counted(warned, "file has warnings", "files have warnings");
            let text = format!("{have}: see the column warnings of the summary");
            notice(P::TOOL, program.common(), &text);
        }
        Ok(Finished { outcome, failure, basis })
    }
}

/// The jobs, in the order of the files.
fn jobs<'b>(left: Vec<Left<'b>>, batch: &Batch, outputs: &[PathBuf]) -> Vec<Job<'b>> {
    // The files that are left are in the order of all files.
    let mut all = batch.files.iter().zip(outputs);
    let job = |left: Left<'b>| {
        let (_, output) = all.find(|(file, _)| *file == left.file)?;
        Some(Job { output: output.file_name()?.into(), left, kept: None })
    };
    left.into_iter().filter_map(job).collect()
}

/// What the headers state, and the files that cannot be opened. Unless the run is to go on, that is an error,
/// before the work begins.
fn survey<'f, P: Rewriter>(
    program: &P,
    jobs: &mut [Job<'f>],
    keep_going: bool,
) -> Result<(Vec<Stated>, Vec<&'f Path>)> {
    let (mut stated, mut failed) = (Vec::new(), Vec::new());
    for job in jobs {
        let path = job.left.file;
        match program.open(path, &job.output) {
            Ok(file) => {
                stated.push(Stated::by(&file));
                job.kept = Some(file).filter(|_| !path.is_file());
            }
            // It fails again when its turn comes.
            Err(_) if keep_going => failed.push(path),
            Err(error) => return Err(error),
        }
    }
    Ok((stated, failed))
}

/// Writes a file.
fn attempt<P: Rewriter>(
    program: &P,
    basis: Option<&P::Basis>,
    job: &Job<'_>,
    folder: &Path,
    taken: &Inputs,
) -> Attempt<Written<P::Counts>, ()> {
    let (path, output) = (job.left.file, folder.join(&job.output));
    let write = || -> Result<Written<P::Counts>> {
        let opened = if job.kept.is_none() { Some(program.open(path, &output)?) } else { None };
        let file = job.kept.as_ref().or(opened.as_ref()).expect("one of them is there");
        let could_not = || Error::usage("could not be opened at first").of_input(file.name());
        let mut written = program.write(basis.ok_or_else(could_not)?, file, &output)?;
        written.notices.splice(0..0, file.notices().iter().cloned());
        Ok(written)
    };
    ledger::attempt(path, &output, taken, || (contained(path, write), ()))
}

/// The row of a file.
fn row<P: Rewriter>(job: &Job<'_>, end: &Attempt<Written<P::Counts>, ()>, batch: &Batch) -> Row {
    let mut row = batch.row(job.left.file, end);
    let (status, code) = match &end.result {
        Ok(_) => ("done", 0),
        Err(error) => ("failed", error.exit_code()),
    };
    row.set("status", status);
    row.set("exit_code", code.to_string());
    if let Ok(Written { counts, bytes, modified, notices }) = &end.result {
        for (column, count) in P::fields(counts) {
            row.set(column, count.to_string());
        }
        row.set("output_bytes", bytes.to_string());
        row.set("output", job.output.to_string_lossy());
        row.set(OUTPUT_TIME, &modified[..]);
        row.set("warnings", notices.join("; "));
    }
    row
}

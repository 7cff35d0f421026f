//! Triangulates many files in parallel. Each file becomes an output and a line of the summary. A file that
//! fails becomes a line too, and the others continue.

mod file;
mod names;
mod summary;

use std::collections::HashSet;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use super::{Options, Stats};
use file::Job;
use spmesh_core::error::{Error, ErrorKind, Result};
use spmesh_core::output::{Output, create_folder};
use spmesh_core::parallel;
use spmesh_core::places::{Inputs, check_apart};
use spmesh_io::source::structure::Format;
use summary::{Done, Summary};

/// Options of a sweep.
#[derive(Debug, Clone)]
pub struct Sweep {
    /// The files; duplicates are done once.
    pub files: Vec<PathBuf>,
    /// The file that lists them, if there is one; no output may replace it.
    pub list: Option<PathBuf>,
    /// Their format; detected from the content if `None`.
    pub format: Option<Format>,
    /// What to do with each of them.
    pub options: Options,
    /// The options in words, for the summary; outputs made with other options are made again.
    pub options_text: String,
    /// Folder of the outputs.
    pub folder: PathBuf,
    /// Where the summary goes; "-" is stdout.
    pub summary: PathBuf,
    /// Number of files in parallel.
    pub threads: usize,
    /// Skip files that the summary lists as done, if their outputs exist.
    pub resume: bool,
    /// Stop at the first file that fails.
    pub strict: bool,
}

/// Outcome of a sweep.
#[derive(Debug, Clone, Default)]
pub struct Outcome {
    /// Files that were done.
    pub done: u64,
    /// Files that had been done before.
    pub skipped: u64,
    /// Files that failed.
    pub failed: u64,
    /// Sums over all models of all files.
    pub stats: Stats,
}

/// Progress of a sweep.
#[derive(Debug)]
pub enum News<'n> {
    /// The number of files.
    Files(u64),
    /// One more file is done, or was skipped.
    Done,
    /// One more file failed.
    Failed(&'n Error),
}

/// Triangulates all files, the largest first, and reports each to `listener`.
///
/// Memory: one file per thread, and the names of all.
///
/// # Errors
/// Usage, before any work, if an output would replace an input; if the folder or the summary cannot be
/// written, or the summary to resume is malformed. With `strict`, the error of the first file that fails;
/// otherwise failures are counted.
pub fn sweep(sweep: &Sweep, listener: &mut dyn FnMut(News<'_>)) -> Result<Outcome> {
    let folder = &sweep.folder;
    let inputs: Vec<&Path> = sweep.files.iter().chain(&sweep.list).map(PathBuf::as_path).collect();
    check_apart(inputs.iter().copied(), &[("--summary", &sweep.summary)])?;
    create_folder(folder)?;
    let mut done = if sweep.resume { Done::read(&sweep.summary)? } else { Done::default() };
    let mut outcome = Outcome::default();
    let mut seen = HashSet::new();
    let files: Vec<&Path> =
        sweep.files.iter().filter(|&file| seen.insert(file)).map(PathBuf::as_path).collect();
    listener(News::Files(files.len() as u64));
    let files = left_to_do(files, &mut done, sweep, &mut |_| {
        outcome.skipped += 1;
        listener(News::Done);
    });
    let jobs = jobs(files, &done);
    // Not an input, but it must not be replaced either.
    let taken = Inputs::of(inputs.into_iter().chain(file_of(&sweep.summary)));
    jobs.iter().try_for_each(|job| file::check(job, sweep, &taken))?;
    check_folder(folder)?;
    let mut summary = Summary::create(&sweep.summary, &done)?;
    let work = |job: &Job<'_>| match file::run(job, sweep, &taken) {
        end if sweep.strict && end.result.is_err() => ControlFlow::Break(end),
        end => ControlFlow::Continue(end),
    };
    parallel::for_each_result(sweep.threads, &jobs, work, |job, end| {
        summary.add(end.lines(job.file, &sweep.options_text))?;
        match end.result {
            Ok(written) => {
                outcome.done += 1;
                written.iter().for_each(|model| outcome.stats.add(&model.report));
                listener(News::Done);
                Ok(())
            }
            Err(error) if sweep.strict || error.kind() == ErrorKind::ClosedPipe => Err(error),
            Err(error) => {
                outcome.failed += 1;
                listener(News::Failed(&error));
                Ok(())
            }
        }
    })?;
    Ok(outcome)
}

/// The path, unless it is that of stdout.
fn file_of(path: &Path) -> Option<&Path> {
    (path != Path::new("-")).then_some(path)
}

/// Checks before the work that outputs can be created in a folder.
fn check_folder(folder: &Path) -> Result<()> {
    Output::create(&folder.join("output.spm"), true).map(drop)
}

/// Estimated ratio of decompression.
const GZIP_FACTOR: u64 = 4;

/// The files that are not done yet; `skip` is called for the others.
fn left_to_do<'f>(
    files: Vec<&'f Path>,
    done: &mut Done,
    sweep: &Sweep,
    skip: &mut dyn FnMut(&Path),
) -> Vec<&'f Path> {
    let mut left = Vec::new();
    for file in files {
        let found = done.file(file, &sweep.options_text);
        if found.is_some_and(|found| file::is_still_there(file, found, &sweep.folder)) {
            skip(file);
        } else {
            done.forget(file);
            left.push(file);
        }
    }
    left
}

/// The jobs, the largest file first: otherwise threads could idle while one works on the largest file at the
/// end.
fn jobs<'f>(files: Vec<&'f Path>, done: &Done) -> Vec<Job<'f>> {
    let stems = names::stems(&files, &done.stems());
    let mut jobs: Vec<(u64, Job<'f>)> =
        files.into_iter().zip(stems).map(|(file, stem)| (work(file), Job { file, stem })).collect();
    jobs.sort_by_key(|(work, _)| std::cmp::Reverse(*work));
    jobs.into_iter().map(|(_, job)| job).collect()
}

/// Estimated number of bytes to read.
fn work(file: &Path) -> u64 {
    let bytes = fs::metadata(file).map_or(0, |metadata| metadata.len());
    let is_compressed = file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gz"));
    if is_compressed { bytes.saturating_mul(GZIP_FACTOR) } else { bytes }
}

//! Many files, several at a time: each becomes an output of its own, and a line of the summary. A file that
//! cannot be triangulated is a line, too, and does not keep the others from being done.

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
use spmesh_core::parallel;
use spmesh_io::source::structure::Format;
use summary::{Done, Summary};

/// A sweep to be done.
#[derive(Debug, Clone)]
pub struct Sweep {
    /// The files; one that is given twice is done once.
    pub files: Vec<PathBuf>,
    /// Their format, if it is not to be told by their content.
    pub format: Option<Format>,
    /// What to do with each of them.
    pub options: Options,
    /// The options in words, for the summary: outputs of other options are not what is wanted.
    pub options_text: String,
    /// Folder of the outputs.
    pub folder: PathBuf,
    /// Where the summary goes; "-" is stdout.
    pub summary: PathBuf,
    /// Files that are worked on at the same time.
    pub threads: usize,
    /// Leave out what the summary calls done, if its outputs are there.
    pub resume: bool,
    /// Stop at the first file that fails.
    pub strict: bool,
}

/// How a sweep went.
#[derive(Debug, Clone, Default)]
pub struct Outcome {
    /// Files that were done.
    pub done: u64,
    /// Files that had been done before.
    pub skipped: u64,
    /// Files that failed.
    pub failed: u64,
    /// What was done, over all models of all files.
    pub stats: Stats,
}

/// What is told while a sweep goes on.
#[derive(Debug)]
pub enum News<'n> {
    /// There are so many files.
    Files(u64),
    /// One more is done, or need not be done again.
    Done,
    /// One more failed.
    Failed(&'n Error),
}

/// Does all files, the largest first, and tells `listener` of each.
///
/// Memory: one file per thread, and the names of all.
///
/// # Errors
/// If the folder or the summary cannot be written, or is none. With `strict`, the error of the first file
/// that fails. Otherwise failures are counted.
pub fn sweep(sweep: &Sweep, listener: &mut dyn FnMut(News<'_>)) -> Result<Outcome> {
    let folder = &sweep.folder;
    fs::create_dir_all(folder)
        .map_err(|e| Error::io("creating the folder", e).of_input(folder.display().to_string()))?;
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
    let mut summary = Summary::create(&sweep.summary, &done)?;
    let work = |job: &Job<'_>| match file::run(job, sweep) {
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

/// About how many times longer a file is when it is decompressed.
const GZIP_FACTOR: u64 = 4;

/// The files that are not done yet; of the others `skip` is told.
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

/// The jobs, the largest file first: if it came last, all threads but one would wait for it.
fn jobs<'f>(files: Vec<&'f Path>, done: &Done) -> Vec<Job<'f>> {
    let stems = names::stems(&files, &done.stems());
    let mut jobs: Vec<(u64, Job<'f>)> =
        files.into_iter().zip(stems).map(|(file, stem)| (work(file), Job { file, stem })).collect();
    jobs.sort_by_key(|(work, _)| std::cmp::Reverse(*work));
    jobs.into_iter().map(|(_, job)| job).collect()
}

/// About the number of bytes to be read, as far as that can be known.
fn work(file: &Path) -> u64 {
    let bytes = fs::metadata(file).map_or(0, |metadata| metadata.len());
    let is_compressed = file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("gz"));
    if is_compressed { bytes.saturating_mul(GZIP_FACTOR) } else { bytes }
}

//! Triangulates many files in parallel. Each file becomes an output and a line of the summary. A file that
//! fails becomes a line too, and the others continue.

mod done;
mod file;
mod row;
mod summary;

use std::collections::{HashMap, HashSet};
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use super::{Options, Stats};
use done::{Done, DoneFile};
use file::Job;
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::output::{Output, create_folder};
use spmesh_base::parallel;
use spmesh_base::places::{Inputs, check_apart};
use spmesh_formats::drivers::Format;
use summary::Summary;

/// Options of a sweep.
#[derive(Debug, Clone)]
pub struct Sweep {
    /// The files, each of them once.
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
    /// The version of the program; outputs that another one made are made again.
    pub version: String,
    /// Where the summary goes; "-" is stdout. If its name ends in `.jsonl` or `.ndjson`, it is written as
    /// JSON Lines.
    pub summary: PathBuf,
    /// Where the summary goes as Parquet when the sweep ends, if anywhere.
    pub parquet: Option<PathBuf>,
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
/// Outputs of this kind that an earlier sweep made of files that are done now are removed before the work. So
/// none is stale, whenever the sweep ends.
///
/// Memory: one file per thread, and the names of all.
///
/// # Errors
/// Usage, before any work, if a file is given twice, an output would replace an input, or another sweep
/// writes to the folder or the summary; if the folder or the summary cannot be written, or the summary to
/// resume is malformed. With `strict`, the error of the first file that fails; otherwise failures are
/// counted.
pub fn sweep(sweep: &Sweep, listener: &mut dyn FnMut(News<'_>)) -> Result<Outcome> {
    let folder = &sweep.folder;
    let files: Vec<&Path> = sweep.files.iter().map(PathBuf::as_path).collect();
    check_distinct(&files)?;
    let inputs: Vec<&Path> = files.iter().copied().chain(sweep.list.as_deref()).collect();
    let summaries = std::iter::once(&sweep.summary).chain(&sweep.parquet).map(|path| ("--summary", &**path));
    check_apart(inputs.iter().copied(), &summaries.collect::<Vec<_>>())?;
    create_folder(folder)?;
    let _folder_lock = done::lock(folder)?;
    let summary_file = file_of(&sweep.summary);
    // Devices and pipes have nothing of an earlier sweep.
    let existing = summary_file.filter(|path| path.is_file());
    let mut summary_lock = existing.map_or(Ok(None), done::lock)?;
    let found = existing.map_or_else(|| Ok(Done::default()), Done::read);
    // Without --resume, an earlier summary only says what is there, and any other file may be in its place.
    let (mut done, mut earlier) =
        if sweep.resume { (found?, Done::default()) } else { (Done::default(), found.unwrap_or_default()) };
    let mut outcome = Outcome::default();
    listener(News::Files(files.len() as u64));
    let names = file::stems(&files, &HashSet::new());
    let names: HashMap<&Path, PathBuf> = files.iter().copied().zip(names).collect();
    let files = left_to_do(files, &mut done, sweep, &mut || {
        outcome.skipped += 1;
        listener(News::Done);
    });
    let files = files.into_iter().map(|(file, known)| (file, known.or_else(|| earlier.take(file)))).collect();
    let jobs = jobs(files, &names, &done, sweep);
    // Not an input, but it must not be replaced either.
    let taken = Inputs::of(inputs.into_iter().chain(summary_file).chain(sweep.parquet.as_deref()));
    jobs.iter().try_for_each(|job| file::check(job, sweep, &taken))?;
    check_folder(folder)?;
    if summary_lock.is_none() {
        summary_lock = summary_file.map_or(Ok(None), done::lock_or_create)?;
    }
    let parquet = sweep.parquet.as_ref().map(|path| Output::create(path, true)).transpose()?;
    // Before the summary forgets them.
    jobs.iter().try_for_each(|job| file::remove_earlier(job, sweep, &taken))?;
    let mut summary = Summary::create(&sweep.summary, &done)?;
    // The new summary has a lock of its own.
    drop(summary_lock);
    let work = |job: &Job<'_>| match file::run(job, sweep, &taken) {
        end if sweep.strict && end.result.is_err() => ControlFlow::Break(end),
        end => ControlFlow::Continue(end),
    };
    parallel::for_each_result(sweep.threads, &jobs, work, |job, end| {
        summary.add(&end.lines(job.file, sweep))?;
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
    if let Some(output) = parquet {
        summary::write_parquet(&sweep.summary, output)?;
    }
    Ok(outcome)
}

fn check_distinct(files: &[&Path]) -> Result<()> {
    let mut places: HashMap<PathBuf, &Path> = HashMap::new();
    for &file in files {
        let place = if file == Path::new("-") { Ok(file.to_path_buf()) } else { std::path::absolute(file) };
        let place = place.unwrap_or_else(|_| file.to_path_buf());
        if let Some(other) = places.insert(place, file) {
            let also = if other == file { String::new() } else { format!(", also as {}", other.display()) };
            let message =
                format!("the file is given twice{also}: leave one out (sort -u removes equal lines)");
            return Err(Error::usage(message).of_input(file.display().to_string()));
        }
    }
    Ok(())
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

/// The files that are not done yet, with what is known of them; `skip` is called for the others.
fn left_to_do<'f>(
    files: Vec<&'f Path>,
    done: &mut Done,
    sweep: &Sweep,
    skip: &mut dyn FnMut(),
) -> Vec<(&'f Path, Option<DoneFile>)> {
    let mut left = Vec::new();
    for file in files {
        let found = done.file(file, &sweep.options_text, &sweep.version);
        if found.is_some_and(|found| file::is_still_there(file, found, &sweep.folder)) {
            skip();
        } else {
            left.push((file, done.take(file)));
        }
    }
    left
}

/// The jobs, the largest file first: otherwise threads could idle while one works on the largest file at the
/// end.
fn jobs<'f>(
    files: Vec<(&'f Path, Option<DoneFile>)>,
    names: &HashMap<&Path, PathBuf>,
    done: &Done,
    sweep: &Sweep,
) -> Vec<Job<'f>> {
    let stems = stems(&files, names, done, sweep);
    let job = |((file, known), stem): ((&'f Path, Option<DoneFile>), PathBuf)| {
        let outputs = known.iter().flat_map(DoneFile::outputs).map(|(output, _)| output);
        (work(file), Job { file, stem, outputs: outputs.filter(|output| done::is_inside(output)).collect() })
    };
    let mut jobs: Vec<(u64, Job<'f>)> = files.into_iter().zip(stems).map(job).collect();
    jobs.sort_by_key(|(work, _)| std::cmp::Reverse(*work));
    jobs.into_iter().map(|(_, job)| job).collect()
}

/// The names of the outputs, without extensions. A sweep that goes on keeps those of before; else they are
/// the `names` of a sweep over all files from the start, unless what is done has them already.
fn stems(
    files: &[(&Path, Option<DoneFile>)],
    names: &HashMap<&Path, PathBuf>,
    done: &Done,
    sweep: &Sweep,
) -> Vec<PathBuf> {
    let of_earlier = |known: &Option<DoneFile>| file::stem(known.as_ref().filter(|_| sweep.resume)?, sweep);
    let mut stems: Vec<Option<PathBuf>> = files.iter().map(|(_, known)| of_earlier(known)).collect();
    let mut taken = done.stems();
    taken.extend(stems.iter().flatten().cloned());
    for (stem, (file, _)) in stems.iter_mut().zip(files) {
        let name = &names[file];
        if stem.is_none() && !taken.contains(name) {
            *stem = Some(name.clone());
        }
    }
    taken.extend(stems.iter().flatten().cloned());
    let others: Vec<&Path> =
        files.iter().zip(&stems).filter(|(_, stem)| stem.is_none()).map(|((file, _), _)| *file).collect();
    let mut others = file::stems(&others, &taken).into_iter();
    stems.into_iter().map(|stem| stem.or_else(|| others.next()).unwrap_or_default()).collect()
}

/// Estimated number of bytes to read.
fn work(file: &Path) -> u64 {
    let bytes = fs::metadata(file).map_or(0, |metadata| metadata.len());
    let is_compressed = file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gz"));
    if is_compressed { bytes.saturating_mul(GZIP_FACTOR) } else { bytes }
}

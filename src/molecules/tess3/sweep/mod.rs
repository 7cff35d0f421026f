//! Triangulates many files in parallel. Each file becomes an output and a line of the summary. A file that
//! fails becomes a line too, and the others continue. What is done stands in a ledger
//! ([`spmesh_formats::ledger`]).

mod file;
mod rows;
mod whole;

use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{Options, Stats};
use file::Job;
pub use rows::COLUMNS;
use spmesh_base::error::Result;
use spmesh_formats::drivers::Format;
use spmesh_formats::ledger::{Batch, Ledger, Left, News, Outcome};
use spmesh_formats::molecules::Structure;
use spmesh_formats::sink::TableFormat;
use whole::Whole;

/// A batch of files, and what to do with each of them.
#[derive(Debug, Clone)]
pub struct Sweep {
    /// The files and the summary, whose columns are [`COLUMNS`].
    pub batch: Batch,
    /// The format of the files; detected from the content if `None`.
    pub format: Option<Format>,
    /// What names the atoms of frames, if they do not.
    pub topology: Option<Arc<Structure>>,
    /// What to do with each of them.
    pub options: Options,
    /// Number of files in parallel.
    pub threads: usize,
    /// One table of all rows, for which the outputs in the folder are parts ([`TableFormat::Rows`]).
    pub table: Option<(PathBuf, TableFormat)>,
}

/// Triangulates all files, the largest first, and reports each to `listener`. Also returns the sums over all
/// models of all files.
///
/// Outputs of this kind that an earlier sweep made of files that are done now are removed before the work. So
/// none is stale, whenever the sweep ends.
///
/// Memory: one file per thread, and the names of all.
///
/// # Errors
/// As [`Ledger::open`], [`Ledger::start`] and [`spmesh_formats::ledger::Running::run`]; usage, before any work, if
/// an output would replace an input.
pub fn sweep(sweep: &Sweep, listener: &mut dyn FnMut(News<'_>)) -> Result<(Outcome, Stats)> {
    let mut ledger = Ledger::open(&sweep.batch)?;
    listener(News::Files(sweep.batch.files.len() as u64));
    let files: Vec<&Path> = sweep.batch.files.iter().map(PathBuf::as_path).collect();
    let names = file::stems(&files, &HashSet::new());
    let names: HashMap<&Path, PathBuf> = files.into_iter().zip(names).collect();
    let left = ledger.left_to_do(&file::is_whole, &mut || listener(News::Done))?;
    let jobs = jobs(left, &names, &ledger, sweep);
    jobs.iter().try_for_each(|job| ledger.check_free(&file::usual_output(job, sweep)))?;
    let table = sweep.table.as_ref();
    let mut whole = table.map(|(path, format)| Whole::new(sweep, *format, path, &ledger)).transpose()?;
    let running = ledger.start(jobs.iter().flat_map(|job| file::earlier_outputs(job, sweep)))?;
    let mut stats = Stats::default();
    let rows = |job: &Job<'_>, end: &file::End| {
        end.result.iter().flatten().for_each(|model| stats.add(&model.report));
        let part = end.result.iter().flatten().next().map(|model| model.output.clone());
        whole.iter_mut().zip(part).for_each(|(whole, part)| whole.add(job.file, part));
        rows::of(job.file, end, sweep)
    };
    let outcome =
        running.run(sweep.threads, &jobs, |job, taken| file::run(job, sweep, taken), rows, listener)?;
    whole.map_or(Ok(()), Whole::write)?;
    Ok((outcome, stats))
}

/// Estimated ratio of decompression.
const GZIP_FACTOR: u64 = 4;

/// The jobs, the largest file first: otherwise threads could idle while one works on the largest file at the
/// end.
fn jobs<'f>(
    left: Vec<Left<'f>>,
    names: &HashMap<&Path, PathBuf>,
    ledger: &Ledger<'_>,
    sweep: &Sweep,
) -> Vec<Job<'f>> {
    let stems = stems(&left, names, ledger, sweep);
    let job = |(Left { file, known }, stem): (Left<'f>, PathBuf)| {
        let outputs = known.iter().flat_map(|known| known.outputs()).collect();
        (work(file), Job { file, stem, outputs })
    };
    let mut jobs: Vec<(u64, Job<'f>)> = left.into_iter().zip(stems).map(job).collect();
    jobs.sort_by_key(|(work, _)| std::cmp::Reverse(*work));
    jobs.into_iter().map(|(_, job)| job).collect()
}

/// The names of the outputs, without extensions. A sweep that goes on keeps those of before; else they are
/// the `names` of a sweep over all files from the start, unless what is done has them already.
fn stems(
    left: &[Left<'_>],
    names: &HashMap<&Path, PathBuf>,
    ledger: &Ledger<'_>,
    sweep: &Sweep,
) -> Vec<PathBuf> {
    let of_earlier =
        |left: &Left<'_>| file::stem_of(left.known.as_ref().filter(|_| sweep.batch.resume)?, sweep);
    let mut stems: Vec<Option<PathBuf>> = left.iter().map(of_earlier).collect();
    let mut taken = stems_of(ledger);
    taken.extend(stems.iter().flatten().cloned());
    for (stem, Left { file, .. }) in stems.iter_mut().zip(left) {
        let name = &names[file];
        if stem.is_none() && !taken.contains(name) {
            *stem = Some(name.clone());
        }
    }
    taken.extend(stems.iter().flatten().cloned());
    let others: Vec<&Path> =
        left.iter().zip(&stems).filter(|(_, stem)| stem.is_none()).map(|(left, _)| left.file).collect();
    let mut others = file::stems(&others, &taken).into_iter();
    stems.into_iter().map(|stem| stem.or_else(|| others.next()).unwrap_or_default()).collect()
}

/// Names of all outputs that stay, without one, two, ... of their extensions.
fn stems_of(ledger: &Ledger<'_>) -> HashSet<PathBuf> {
    let stems = ledger.outputs().flat_map(|(_, output)| {
        std::iter::successors(Some(output.with_extension("")), |stem| {
            stem.extension().map(|_| stem.with_extension(""))
        })
    });
    stems.collect()
}

/// Estimated number of bytes to read.
fn work(file: &Path) -> u64 {
    let bytes = fs::metadata(file).map_or(0, |metadata| metadata.len());
    let is_compressed = file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gz"));
    if is_compressed { bytes.saturating_mul(GZIP_FACTOR) } else { bytes }
}

//! The work of a batch: file by file, each with its rows in the summary.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::{Duration, Instant};

use super::row::Row;
use super::state::FileState;
use super::summary::{Summary, write_parquet};
use super::{Batch, Lock, remove};
use crate::source::panic_guard::guarded;
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::output::Output;
use spmesh_base::parallel;
use spmesh_base::places::Inputs;

/// Outcome of a batch.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Outcome {
    /// Files that were done.
    pub done: u64,
    /// Files that had been done before.
    pub skipped: u64,
    /// Files that failed.
    pub failed: u64,
}

/// Progress of a batch.
#[derive(Debug)]
pub enum News<'n> {
    /// The number of files.
    Files(u64),
    /// One more file is done, or was skipped.
    Done,
    /// One more file failed.
    Failed(&'n Error),
}

/// The work on a file, after it has ended.
#[derive(Debug)]
pub struct Attempt<T, N> {
    /// What came of it.
    pub result: Result<T>,
    /// What was noted, whether it failed or not.
    pub noted: N,
    /// The file before it was read, if it is a regular one.
    pub input: Option<FileState>,
    /// The time that it took.
    pub time: Duration,
}

/// Works on a file. If that fails, nothing is left under the name `output`, unless it is one of the files
/// that are `taken`.
pub fn attempt<T, N>(
    file: &Path,
    output: &Path,
    taken: &Inputs,
    work: impl FnOnce() -> (Result<T>, N),
) -> Attempt<T, N> {
    let started = Instant::now();
    let input = FileState::of(file).ok().flatten();
    let (result, noted) = work();
    let removed = if result.is_err() { remove(output, taken) } else { Ok(()) };
    Attempt { result: removed.and(result), noted, input, time: started.elapsed() }
}

/// Works on a file; a panic is an error of this file.
///
/// # Errors
/// That of the work.
pub fn contained<T>(file: &Path, work: impl FnOnce() -> Result<T>) -> Result<T> {
    guarded(work).unwrap_or_else(|panic| {
        let message = format!("internal error: {panic}; please report it with the file");
        Err(Error::new(ErrorKind::Io, message).of_input(file.display().to_string()))
    })
}

/// A batch whose summary has begun.
pub struct Running<'b> {
    pub(super) batch: &'b Batch,
    pub(super) summary: Summary,
    pub(super) parquet: Option<Output>,
    /// The file that all outputs depend on, with the prefix of its columns.
    pub(super) shared: Option<(&'static str, FileState)>,
    pub(super) taken: Inputs,
    pub(super) skipped: u64,
    pub(super) _folder_lock: Option<Lock>,
}

impl Running<'_> {
    /// Works on files, `threads` at the same time. `work` gets the files that no output may replace; `rows`
    /// makes the rows of a file, on the calling thread. Each file is reported to `listener`.
    ///
    /// # Errors
    /// If the summary cannot be written, or its reader closes it. In a strict batch, the error of the first file
    /// that fails; otherwise failures are counted.
    pub fn run<J: Sync, T: Send, N: Send>(
        mut self,
        threads: usize,
        jobs: &[J],
        work: impl Fn(&J, &Inputs) -> Attempt<T, N> + Sync,
        mut rows: impl FnMut(&J, &Attempt<T, N>) -> Vec<Row>,
        listener: &mut dyn FnMut(News<'_>),
    ) -> Result<Outcome> {
        let mut outcome = Outcome { skipped: self.skipped, ..Outcome::default() };
        let is_strict = self.batch.strict;
        let work = |job: &J| match work(job, &self.taken) {
            end if is_strict && end.result.is_err() => ControlFlow::Break(end),
            end => ControlFlow::Continue(end),
        };
        let (summary, shared) = (&mut self.summary, &self.shared);
        parallel::for_each_result(threads, jobs, work, |job, end| {
            let mut rows = rows(job, &end);
            if let Some((prefix, state)) = shared {
                rows.iter_mut().for_each(|row| state.enter(row, prefix));
            }
            summary.add(&rows)?;
            match end.result {
                Ok(_) => {
                    outcome.done += 1;
                    listener(News::Done);
                    Ok(())
                }
                Err(error) if is_strict || error.kind() == ErrorKind::ClosedPipe => Err(error),
                Err(error) => {
                    outcome.failed += 1;
                    listener(News::Failed(&error));
                    Ok(())
                }
            }
        })?;
        if let Some(output) = self.parquet {
            write_parquet(&self.batch.summary, self.batch.columns, output)?;
        }
        Ok(outcome)
    }
}

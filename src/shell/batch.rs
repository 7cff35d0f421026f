//! Batches of many files: their flags, progress and messages.

use std::path::{Path, PathBuf};

use clap::Args;

use super::progress::Progress;
use super::{Common, endings, notice, read_list, refuse_terminal};
use spmesh_base::error::{Error, ErrorKind, Result, counted};
use spmesh_formats::ledger::{News, Outcome};
use spmesh_formats::sink::TableFormat;

/// Endings of summaries. Lines of JSON are no JSON, and tabs no commas, so `.json` and `.csv` are none of
/// them.
pub const SUMMARY_ENDINGS: &[&str] = &["tsv", "txt", "xyz", "jsonl", "ndjson", "parquet"];

/// Flags of programs that turn many files into outputs in a folder.
#[derive(Debug, Clone, Args)]
pub struct BatchFlags {
    /// Folder for the outputs of many files; it is made if necessary
    #[arg(long, value_name = "FOLDER")]
    pub out_dir: Option<PathBuf>,

    /// File with names of input files, one per line; - is stdin. Empty lines and lines that start with # do
    /// not count
    #[arg(long, value_name = "FILE")]
    pub lof: Option<PathBuf>,

    /// Where the summary goes, a line per output: a table, JSON Lines if the name ends in .jsonl, or Parquet
    /// if it ends in .parquet; - is stdout
    #[arg(long, value_name = "FILE", requires = "out_dir")]
    pub summary: Option<PathBuf>,

    /// Skip the files that an earlier run to the same folder has done with the same flags, and that are the
    /// same still by size, and by time or content
    #[arg(long, requires = "out_dir", visible_alias = "skip-existing")]
    pub resume: bool,

    /// Go on with the other files when one fails
    #[arg(long, requires = "out_dir")]
    pub keep_going: bool,
}

/// Where a summary goes.
#[derive(Debug, Clone)]
pub struct SummaryPaths {
    /// What messages point to.
    pub shown: PathBuf,
    /// The summary that grows with each file.
    pub summary: PathBuf,
    /// The same as Parquet at the end, if that is asked for.
    pub parquet: Option<PathBuf>,
}

impl BatchFlags {
    /// As [`listed`].
    ///
    /// # Errors
    /// As [`listed`].
    pub fn files(&self, inputs: &[PathBuf]) -> Result<Vec<PathBuf>> {
        listed(inputs, self.lof.as_deref())
    }

    /// The folder of outputs, if a summary is wanted, or is needed for what is.
    ///
    /// # Errors
    /// Usage, if there is no folder for it. Beside a flag that excludes --out-dir, clap does not ask for it.
    pub fn with_summary(&self) -> Result<Option<&Path>> {
        let is_wanted = self.keep_going || self.resume || self.summary.is_some();
        if is_wanted && self.out_dir.is_none() {
            return Err(Error::usage("--summary, --resume and --keep-going go with --out-dir"));
        }
        Ok(self.out_dir.as_deref().filter(|_| is_wanted))
    }

    /// Where the summary goes: by default, to `name` in the folder of outputs.
    ///
    /// # Errors
    /// Usage, if its name is that of another format, or it is to be resumed from stdout.
    pub fn summary_paths(&self, folder: &Path, name: &str) -> Result<SummaryPaths> {
        let shown = self.summary.clone().unwrap_or_else(|| folder.join(name));
        endings::check(&shown, &[SUMMARY_ENDINGS])?;
        let is_parquet = TableFormat::of(&shown) == Some(TableFormat::Parquet);
        // Parquet is written at the end. Until then, and for --resume, the summary is in its usual place.
        let summary = if is_parquet { folder.join(name) } else { shown.clone() };
        if self.resume && summary == Path::new("-") {
            let message = "--resume reads the summary of the earlier run: give it a file with --summary";
            return Err(Error::usage(message));
        }
        Ok(SummaryPaths { parquet: is_parquet.then(|| shown.clone()), shown, summary })
    }
}

/// The files of the command line, then those of a list.
///
/// # Errors
/// As [`read_list`]; usage, if there is no file, or stdin is asked for twice or is a terminal.
pub fn listed(inputs: &[PathBuf], list: Option<&Path>) -> Result<Vec<PathBuf>> {
    let stdin = Path::new("-");
    let mut files = inputs.to_vec();
    if let Some(path) = list {
        files.extend(read_list(path)?);
    }
    if list == Some(stdin) && files.iter().any(|file| file == stdin) {
        return Err(Error::usage("the list of files and a file cannot both come from stdin"));
    }
    if files.is_empty() {
        return Err(Error::usage("no input: give files, or a list of them with --lof (see --help)"));
    }
    if files.iter().any(|file| file == stdin) {
        refuse_terminal()?;
    }
    Ok(files)
}

/// Progress and messages of a batch.
pub struct BatchMessages<'c> {
    tool: &'static str,
    /// What is done with files, such as "triangulating".
    work: &'static str,
    common: &'c Common,
    progress: Option<Progress>,
    done: u64,
}

impl<'c> BatchMessages<'c> {
    /// Messages of a tool that is `work`ing on files.
    pub fn new(tool: &'static str, work: &'static str, common: &'c Common) -> BatchMessages<'c> {
        BatchMessages { tool, work, common, progress: None, done: 0 }
    }

    /// Shows how far the batch is, and which files failed.
    pub fn hear(&mut self, news: News<'_>) {
        match news {
            News::Files(files) => {
                self.progress = Some(Progress::counting("files", self.common, self.work, Some(files)));
            }
            News::Done => self.done += 1,
            News::Failed(error) => {
                self.done += 1;
                self.progress.iter().for_each(|bar| bar.say(&format!("{}: {error}", self.tool)));
            }
        }
        let done = self.done;
        self.progress.iter_mut().for_each(|bar| bar.set(done));
    }

    /// Says what was done. If files failed, that is the failure of the run, which is returned.
    pub fn conclude(self, outcome: &Outcome, summary: &Path) -> Option<Error> {
        drop(self.progress);
        let &Outcome { done, skipped, failed } = outcome;
        let before = if skipped > 0 { format!(", {skipped} had been done before") } else { String::new() };
        let see =
            if summary == Path::new("-") { String::new() } else { format!("; see {}", summary.display()) };
        if failed > 0 {
            let files = counted(done + skipped + failed, "file", "files");
            return Some(Error::new(ErrorKind::Io, format!("{failed} of {files} failed{before}{see}")));
        }
        let files = counted(done, "file", "files");
        notice(self.tool, self.common, &format!("{files} done{before}{see}"));
        None
    }
}

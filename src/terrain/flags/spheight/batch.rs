//! Many files with a summary: what is done already is skipped, and a file that fails need not end the others.

use std::path::{Path, PathBuf};

use super::{Finished, Flags, Stated, TOOL, Written};
use crate::height::{Ground, Outside};
use spmesh_base::error::{Error, Result, counted};
use spmesh_base::places::Inputs;
use spmesh_formats::ledger::{
    self, Attempt, Batch, Columns, Ledger, Left, News, OUTPUT_TIME, Row, SharedInput, contained,
};
use spmesh_formats::sink::ColumnKind::{Integer, Number, Text};
use spmesh_formats::source::PointFile;
use spmesh_shell::batch::BatchMessages;
use spmesh_shell::value_name;

/// The name of the summary in the folder of outputs.
const SUMMARY_NAME: &str = "summary.jsonl";

/// The columns of the summary. Readers take them by name; new ones come last.
const COLUMNS: Columns = &[
    ("file", Text),
    ("output", Text),
    ("status", Text),
    ("exit_code", Integer),
    ("error", Text),
    ("warnings", Text),
    ("points", Integer),
    ("without_height", Integer),
    ("outside", Integer),
    ("below_ground", Integer),
    ("seconds", Number),
    ("output_bytes", Integer),
    (OUTPUT_TIME, Text),
    ("options", Text),
    ("version", Text),
    ("input_bytes", Integer),
    ("input_modified", Text),
    ("input_sha256", Text),
    ("ground_bytes", Integer),
    ("ground_modified", Text),
    ("ground_sha256", Text),
];

/// A file to write again.
struct Job<'f> {
    left: Left<'f>,
    /// Name of the output in the folder.
    output: PathBuf,
    /// The file, if it can be opened once only.
    kept: Option<PointFile>,
}

type End = Attempt<Written, ()>;

/// Writes the files that are not done yet to a folder.
///
/// # Errors
/// As [`Ledger::open`], [`Ledger::start`] and [`ledger::Running::run`], and if the ground cannot be read.
pub(super) fn run(
    flags: &Flags,
    folder: &Path,
    files: Vec<PathBuf>,
    outputs: Vec<PathBuf>,
) -> Result<Finished> {
    let paths = flags.batch.summary_paths(folder, SUMMARY_NAME)?;
    let batch = Batch {
        program: TOOL,
        version: env!("CARGO_PKG_VERSION").to_string(),
        files,
        list: flags.batch.lof.clone(),
        shared: Some(SharedInput { path: flags.ground.clone(), prefix: "ground" }),
        options: flags.options_text(),
        folder: folder.to_path_buf(),
        summary: paths.summary,
        parquet: paths.parquet,
        columns: COLUMNS,
        resume: flags.batch.resume,
        strict: !flags.batch.keep_going,
    };
    let mut ledger = Ledger::open(&batch)?;
    let mut messages = BatchMessages::new(TOOL, "finding heights", &flags.common);
    messages.hear(News::Files(batch.files.len() as u64));
    let left = ledger.left_to_do(&|_| true, &mut || messages.hear(News::Done))?;
    let mut jobs = jobs(left, &batch, &outputs);
    ledger.claim(jobs.iter().map(|job| (job.left.file, &*job.output)))?;
    let outputs: Vec<PathBuf> = jobs.iter().map(|job| folder.join(&job.output)).collect();
    outputs.iter().try_for_each(|output| ledger.check_free(output))?;
    let window = flags.window(survey(flags, &mut jobs)?);
    let mut finished = Finished::default();
    let mut ground = None;
    if !jobs.is_empty() {
        let (read, bytes) = flags.ground(window, &outputs)?;
        (finished.triangles, finished.ground_bytes) = (read.triangles(), bytes);
        ground = Some(read);
    }
    let earlier: Vec<PathBuf> =
        jobs.iter().filter_map(|job| job.left.known.as_ref()).flat_map(|known| known.outputs()).collect();
    let running = ledger.start(earlier.iter().map(PathBuf::as_path))?;
    let mut warned = 0;
    let rows = |job: &Job<'_>, end: &End| {
        if let Ok(written) = &end.result {
            finished.sums.add(written);
            warned += u64::from(!written.notices.is_empty());
        }
        vec![row(job, end, &batch)]
    };
    let work = |job: &Job<'_>, taken: &Inputs| attempt(flags, ground.as_ref(), job, folder, taken);
    // One at a time: each is worked on by several threads.
    finished.outcome = running.run(1, &jobs, work, rows, &mut |news| messages.hear(news))?;
    finished.failure = messages.conclude(&finished.outcome, &paths.shown);
    if warned > 0 {
        let have = counted(warned, "file has warnings", "files have warnings");
        flags.notice(&format!("{have}: see the column warnings of the summary"));
    }
    Ok(finished)
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

/// What the headers state. Unless a file that fails is to end the run, it is an error, before the work
/// begins.
fn survey(flags: &Flags, jobs: &mut [Job<'_>]) -> Result<Vec<Stated>> {
    let mut stated = Vec::new();
    for job in jobs {
        let path = job.left.file;
        match flags.open(path, &job.output) {
            Ok(file) => {
                stated.push(Stated::by(&file));
                job.kept = Some(file).filter(|_| !path.is_file());
            }
            // It fails again when its turn comes.
            Err(_) if flags.batch.keep_going => {}
            Err(error) => return Err(error),
        }
    }
    Ok(stated)
}

/// Writes a file.
fn attempt(flags: &Flags, ground: Option<&Ground>, job: &Job<'_>, folder: &Path, taken: &Inputs) -> End {
    let (path, output) = (job.left.file, folder.join(&job.output));
    let write = || -> Result<Written> {
        let ground = ground.ok_or_else(|| Error::usage("there is no ground"))?;
        let opened = if job.kept.is_none() { Some(flags.open(path, &output)?) } else { None };
        let file = job.kept.as_ref().or(opened.as_ref()).expect("one of them is there");
        let mut written = flags.write(ground, file, &output, |_| {})?;
        written.notices.splice(0..0, file.notices().iter().cloned());
        Ok(written)
    };
    ledger::attempt(path, &output, taken, || (contained(path, write), ()))
}

/// The row of a file.
fn row(job: &Job<'_>, end: &End, batch: &Batch) -> Row {
    let mut row = batch.row(job.left.file, end);
    let (status, code) = match &end.result {
        Ok(_) => ("done", 0),
        Err(error) => ("failed", error.exit_code()),
    };
    row.set("status", status);
    row.set("exit_code", code.to_string());
    if let Ok(Written { counts, bytes, modified, notices }) = &end.result {
        for (column, count) in [
            ("points", counts.points),
            ("without_height", counts.without),
            ("outside", counts.outside),
            ("below_ground", counts.below),
            ("output_bytes", *bytes),
        ] {
            row.set(column, count.to_string());
        }
        row.set("output", job.output.to_string_lossy());
        row.set(OUTPUT_TIME, &modified[..]);
        row.set("warnings", notices.join("; "));
    }
    row
}

impl Flags {
    /// The options that determine the content of the outputs, as text.
    fn options_text(&self) -> String {
        let place = if self.replace_z { "--replace-z".to_string() } else { format!("--name {}", self.name) };
        let outside: Outside = self.outside();
        let mut text = format!("{place} --outside {}", value_name(super::OUTSIDE, &outside));
        if let Some(format) = self.format {
            text += &format!(" --format {}", value_name(super::ENDINGS, &format));
        }
        let crs = self.crs.text().map_or(String::new(), |crs| format!(" --crs {crs}"));
        text + &crs + &self.text.to_string()
    }
}

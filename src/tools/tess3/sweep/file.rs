//! One file of a sweep.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::Sweep;
use super::summary::{DoneFile, Line, Written};
use crate::heap::peak_during;
use crate::{ModelName, Product, Report, job};
use spmesh_core::error::{Error, ErrorKind, Result};
use spmesh_core::output::{Output, create_folder};
use spmesh_core::places::Inputs;
use spmesh_io::source::panic_guard::guarded;
use spmesh_io::source::structure::{Models, Structure, read_structure};
use spmesh_stream::ends_with_end;

/// A file to triangulate.
#[derive(Debug)]
pub(super) struct Job<'f> {
    pub(super) file: &'f Path,
    /// Name of the output without its extension, relative to the folder of outputs.
    pub(super) stem: PathBuf,
}

/// The result of a job.
#[derive(Debug)]
pub(super) struct End {
    pub(super) result: Result<Vec<Model>>,
    time: Duration,
    peak_memory: Option<u64>,
}

/// A model that was written.
#[derive(Debug)]
pub(super) struct Model {
    pub(super) report: Report,
    output: PathBuf,
    bytes: u64,
}

impl End {
    /// The lines of the summary: one per model, or one for the failure.
    pub(super) fn lines<'l>(&'l self, file: &'l Path, options: &'l str) -> Vec<Line<'l>> {
        let line = |time, result| Line { file, options, time, peak_memory: self.peak_memory, result };
        match &self.result {
            Err(error) => vec![line(self.time, Err(error))],
            Ok(models) => {
                let written = models.iter().map(|Model { report, output, bytes }| {
                    line(report.times.total(), Ok(Written { report, output, bytes: *bytes }))
                });
                written.collect()
            }
        }
    }
}

/// Checks before the work that the output of a file replaces none of the files that are `taken`.
///
/// # Errors
/// Usage, if it does.
pub(super) fn check(job: &Job<'_>, sweep: &Sweep, taken: &Inputs) -> Result<()> {
    check_free(&sweep.folder.join(output_name(&job.stem, sweep.options.product, None)), taken)
}

fn check_free(output: &Path, taken: &Inputs) -> Result<()> {
    let Some(file) = taken.at(output) else { return Ok(()) };
    let message = format!("the output would replace {file}: give another --out-dir");
    Err(Error::usage(message).of_input(output.display().to_string()))
}

/// Triangulates a file. A panic is an error of this file.
pub(super) fn run(job: &Job<'_>, sweep: &Sweep, taken: &Inputs) -> End {
    let started = Instant::now();
    let (result, peak_memory) = peak_during(|| guarded(|| triangulate(job, sweep, taken)));
    let result = result.unwrap_or_else(|panic| {
        let message = format!("internal error: {panic}; please report it with the file");
        Err(Error::new(ErrorKind::Io, message).of_input(job.file.display().to_string()))
    });
    End { result, time: started.elapsed(), peak_memory }
}

fn triangulate(job: &Job<'_>, sweep: &Sweep, taken: &Inputs) -> Result<Vec<Model>> {
    let started = Instant::now();
    let structure = read_structure(job.file, sweep.format)?;
    let read = started.elapsed();
    let has_distinct_numbers = has_distinct_numbers(&structure);
    let mut outputs: Vec<PathBuf> = Vec::new();
    let mut open = |model: Option<ModelName>| {
        let model = model.filter(|_| sweep.options.selection.models == Models::All);
        let model = model.map(|name| if has_distinct_numbers { name.number } else { name.place as i64 });
        let output = output_name(&job.stem, sweep.options.product, model);
        let path = sweep.folder.join(&output);
        create_folder_of(&path)?;
        check_free(&path, taken)?;
        outputs.push(output);
        Output::create(&path, true)
    };
    let mut reports = job::run(structure, &sweep.options, &mut open)?;
    reports.iter_mut().take(1).for_each(|report| report.times.read = read);
    let mut models = Vec::new();
    for (i, report) in reports.into_iter().enumerate() {
        // All models share one table.
        let output = outputs[i.min(outputs.len() - 1)].clone();
        let path = sweep.folder.join(&output);
        let length = fs::metadata(&path).map(|metadata| metadata.len());
        let bytes =
            length.map_err(|e| Error::io("looking at the output", e).of_input(path.display().to_string()))?;
        models.push(Model { report, output, bytes });
    }
    Ok(models)
}

fn has_distinct_numbers(structure: &Structure) -> bool {
    let mut numbers: Vec<i64> = structure.models.iter().map(|model| model.number).collect();
    numbers.sort_unstable();
    numbers.windows(2).all(|pair| pair[0] < pair[1])
}

/// Stem, model and the extension of the product.
fn output_name(stem: &Path, product: Product, model: Option<i64>) -> PathBuf {
    let mut name = stem.as_os_str().to_os_string();
    if let Some(number) = model.filter(|_| product == Product::Mesh) {
        name.push(format!(".model{number}"));
    }
    name.push(match product {
        Product::Mesh => ".spm",
        Product::Tetrahedra => ".tetrahedra.tsv",
        Product::Contacts => ".contacts.tsv",
    });
    name.into()
}

fn create_folder_of(path: &Path) -> Result<()> {
    path.parent().map_or(Ok(()), create_folder)
}

/// Whether the outputs that an earlier run made of a file still exist, are complete, and are not older than
/// the file.
pub(super) fn is_still_there(file: &Path, done: &DoneFile, folder: &Path) -> bool {
    let changed = |path: &Path| fs::metadata(path).and_then(|metadata| metadata.modified()).ok();
    let input_changed = changed(file);
    done.outputs.iter().all(|(output, bytes)| {
        let path = folder.join(output);
        let is_complete = || -> std::io::Result<bool> {
            let mut output = File::open(&path)?;
            let is_mesh = path.extension().is_some_and(|extension| extension == "spm");
            Ok(output.metadata()?.len() == *bytes && (!is_mesh || ends_with_end(&mut output)?))
        };
        is_complete().unwrap_or(false) && input_changed <= changed(&path)
    })
}

//! One file of a sweep, and the short, distinct names of outputs.

use std::collections::{HashMap, HashSet};
use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::path::{Component, Path, PathBuf};
use std::time::Instant;

use super::Sweep;
use crate::tess3::heap::peak_during;
use crate::tess3::{ModelName, Options, Product, Report, job, run_frames};
use spmesh_base::error::{Error, Result};
use spmesh_base::output::{Output, create_folder};
use spmesh_base::places::Inputs;
use spmesh_formats::ledger::{self, Attempt, DoneFile, check_free, contained};
use spmesh_formats::molecules::{FrameReader, Structure, read_structure};
use spmesh_stream::ends_with_end;

/// A file to triangulate.
#[derive(Debug)]
pub(super) struct Job<'f> {
    pub(super) file: &'f Path,
    /// Name of the output without its extension, relative to the folder of outputs.
    pub(super) stem: PathBuf,
    /// Outputs of an earlier sweep of this file.
    pub(super) outputs: Vec<PathBuf>,
}

/// The models of a file, and the peak of memory in bytes, if it was measured.
pub(super) type End = Attempt<Vec<Model>, Option<u64>>;

/// A model that was written.
#[derive(Debug)]
pub(super) struct Model {
    pub(super) report: Report,
    /// Path of the output, relative to the folder of outputs.
    pub(super) output: PathBuf,
    pub(super) bytes: u64,
    pub(super) warnings: Vec<String>,
}

/// The path of the output of a file that makes one.
pub(super) fn usual_output(job: &Job<'_>, sweep: &Sweep) -> PathBuf {
    sweep.batch.folder.join(output_name(&job.stem, &sweep.options, None))
}

/// The name of the outputs that an earlier sweep made of a file, without the number of a model and the
/// extension; `None` if it made none of this kind.
pub(super) fn stem_of(known: &DoneFile, sweep: &Sweep) -> Option<PathBuf> {
    let ending = ending(&sweep.options);
    known.outputs().find_map(|output| {
        let name = output.to_str()?.strip_suffix(&ending)?;
        let plain = name.rsplit_once(".model").filter(|(_, number)| number.parse::<i64>().is_ok());
        let is_numbered = sweep.options.are_models_several() && sweep.options.is_per_model();
        Some(PathBuf::from(plain.filter(|_| is_numbered).map_or(name, |(plain, _)| plain)))
    })
}

/// The outputs of this kind that an earlier sweep made of a file.
pub(super) fn earlier_outputs<'j>(job: &'j Job<'_>, sweep: &Sweep) -> impl Iterator<Item = &'j Path> {
    let ending = ending(&sweep.options);
    let outputs = job.outputs.iter().map(PathBuf::as_path);
    outputs.filter(move |output| output.to_string_lossy().ends_with(&ending))
}

/// Whether an output is complete, as far as its content tells.
pub(super) fn is_whole(output: &Path) -> bool {
    let is_mesh = output.extension().is_some_and(|extension| extension == "spm");
    !is_mesh || File::open(output).is_ok_and(|mut file| ends_with_end(&mut file).unwrap_or(false))
}

/// Triangulates a file.
pub(super) fn run(job: &Job<'_>, sweep: &Sweep, taken: &Inputs) -> End {
    ledger::attempt(job.file, &usual_output(job, sweep), taken, || {
        peak_during(|| contained(job.file, || triangulate(job, sweep, taken)))
    })
}

fn triangulate(job: &Job<'_>, sweep: &Sweep, taken: &Inputs) -> Result<Vec<Model>> {
    let started = Instant::now();
    let input = match sweep.options.frames {
        Some(range) => {
            let topology = sweep.topology.as_deref();
            Input::Frames(FrameReader::open(job.file, sweep.format, range, topology)?)
        }
        None => Input::Structure(read_structure(job.file, sweep.format)?),
    };
    let read = started.elapsed();
    let has_distinct_numbers = input.has_distinct_numbers();
    let mut of_file = input.notices(sweep);
    let mut outputs: Vec<PathBuf> = Vec::new();
    let mut open = |model: Option<ModelName>| {
        let model = model.filter(|_| sweep.options.are_models_several());
        let model = model.map(|name| if has_distinct_numbers { name.number } else { name.place as i64 });
        let output = output_name(&job.stem, &sweep.options, model);
        let path = sweep.batch.folder.join(&output);
        create_folder_of(&path)?;
        check_free(&path, taken)?;
        outputs.push(output);
        Output::create(&path, true)
    };
    let mut reports = Vec::new();
    match input {
        Input::Frames(frames) => {
            run_frames(frames, &sweep.options, &mut open, &mut |report| reports.push(report))?
        }
        Input::Structure(structure) => reports = job::run(structure, &sweep.options, &mut open)?,
    }
    reports.iter_mut().take(1).for_each(|report| report.times.read += read);
    let mut models = Vec::new();
    for (i, report) in reports.into_iter().enumerate() {
        // All models share one table.
        let output = outputs[i.min(outputs.len() - 1)].clone();
        let path = sweep.batch.folder.join(&output);
        let length = fs::metadata(&path).map(|metadata| metadata.len());
        let bytes =
            length.map_err(|e| Error::io("looking at the output", e).of_input(path.display().to_string()))?;
        // Those of the file are in the first row.
        let mut warnings = std::mem::take(&mut of_file);
        warnings.extend(report.warnings());
        models.push(Model { report, output, bytes, warnings });
    }
    Ok(models)
}

/// What is read of a file.
enum Input {
    Structure(Structure),
    Frames(FrameReader),
}

impl Input {
    /// Whether the numbers of models tell them apart.
    fn has_distinct_numbers(&self) -> bool {
        let Input::Structure(structure) = self else { return true };
        let mut numbers: Vec<i64> = structure.models.iter().map(|model| model.number).collect();
        numbers.sort_unstable();
        numbers.windows(2).all(|pair| pair[0] < pair[1])
    }

    /// What a user may not expect of the file.
    fn notices(&self, sweep: &Sweep) -> Vec<String> {
        match self {
            Input::Structure(structure) => {
                structure.notices(&sweep.options.selection, sweep.options.periodic.is_some())
            }
            Input::Frames(_) => Vec::new(),
        }
    }
}

/// Stem, model and the extension of the product.
fn output_name(stem: &Path, options: &Options, model: Option<i64>) -> PathBuf {
    let mut name = stem.as_os_str().to_os_string();
    if let Some(number) = model.filter(|_| options.product.is_per_model()) {
        name.push(format!(".model{number}"));
    }
    name.push(ending(options));
    name.into()
}

fn ending(options: &Options) -> String {
    let table = match options.product {
        Product::Mesh => return ".spm".to_string(),
        Product::Filtration => return ".filtration.txt".to_string(),
        Product::Tetrahedra => "tetrahedra",
        Product::Contacts => "contacts",
        Product::Cells => "cells",
        Product::Surface => "surface",
        Product::ContactAreas => "contact-areas",
        Product::BuriedAreas => "buried-areas",
        Product::Pockets => "pockets",
        Product::SiteCells(_) => "voronoi-cells",
        Product::SiteFaces => "voronoi-faces",
    };
    format!(".{table}.{}", options.format.ending())
}

fn create_folder_of(path: &Path) -> Result<()> {
    path.parent().map_or(Ok(()), create_folder)
}

/// Extensions of inputs that denote a format only.
const FORMATS: [&str; 17] = [
    "pdb", "ent", "pqr", "cif", "mmcif", "gro", "xtc", "trr", "dcd", "xyz", "txt", "csv", "dat", "asc",
    "spm", "ply", "obj",
];

/// The name of the output of each input, without its extension: relative to the folder of outputs, and none
/// of `taken`.
///
/// The name is the base name without the extension of its format. If several inputs would get the same name,
/// it keeps the extension; if that does not suffice, it gets as many parent folders as needed. Names that
/// differ in case only count as equal, because some file systems ignore case.
pub(super) fn stems(inputs: &[&Path], taken: &HashSet<PathBuf>) -> Vec<PathBuf> {
    let taken: HashSet<OsString> = taken.iter().map(|path| folded(path)).collect();
    let levels_max: Vec<usize> = inputs.iter().map(|input| parts(input).len()).collect();
    let mut levels = vec![0; inputs.len()];
    loop {
        let stems: Vec<PathBuf> =
            inputs.iter().zip(&levels).map(|(input, &level)| name_with(input, level)).collect();
        let mut uses: HashMap<OsString, usize> = HashMap::new();
        stems.iter().for_each(|stem| *uses.entry(folded(stem)).or_default() += 1);
        let mut changed = false;
        for (i, stem) in stems.iter().enumerate() {
            let name = folded(stem);
            if (uses[&name] > 1 || taken.contains(&name)) && levels[i] < levels_max[i] {
                levels[i] += 1;
                changed = true;
            }
        }
        if !changed {
            return numbered(stems, taken);
        }
    }
}

/// Numbers names that are still equal.
fn numbered(mut stems: Vec<PathBuf>, mut taken: HashSet<OsString>) -> Vec<PathBuf> {
    for stem in &mut stems {
        let plain = stem.clone().into_os_string();
        let mut number = 1;
        while !taken.insert(folded(stem)) {
            number += 1;
            let mut name = plain.clone();
            name.push(format!("-{number}"));
            *stem = name.into();
        }
    }
    stems
}

/// The name at a level: without extension, with extension, then with one more folder per level.
fn name_with(input: &Path, level: usize) -> PathBuf {
    let parts = parts(input);
    match (level, parts.split_last()) {
        (_, None) => PathBuf::from("input"),
        (0, Some((base, _))) => without_extension(base).into(),
        (level, Some(_)) => parts[parts.len() - level.min(parts.len())..].iter().collect(),
    }
}

/// The folders of an input and its base name.
fn parts(input: &Path) -> Vec<OsString> {
    if input == Path::new("-") {
        return vec!["stdin".into()];
    }
    let path = std::path::absolute(input).unwrap_or_else(|_| input.to_path_buf());
    let normal = path.components().filter_map(|part| match part {
        Component::Normal(name) => Some(name.to_os_string()),
        _ => None,
    });
    normal.collect()
}

fn without_extension(base: &OsStr) -> OsString {
    let is = |name: &Path, extensions: &[&str]| {
        let extension = name.extension().and_then(OsStr::to_str).unwrap_or_default().to_ascii_lowercase();
        extensions.contains(&&extension[..])
    };
    let mut name = Path::new(base).to_path_buf();
    for extensions in [&["gz"][..], &FORMATS] {
        if is(&name, extensions) {
            name.set_extension("");
        }
    }
    name.into_os_string()
}

fn folded(path: &Path) -> OsString {
    path.as_os_str().to_ascii_lowercase()
}

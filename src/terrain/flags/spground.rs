//! `spground`: flags.

mod batch;
mod parameters;
mod plans;
mod report;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Parser;

use parameters::ParameterFlags;
use plans::{Around, PlanFlags};
use report::rows;

use super::names::{FormatFlag, OutputNames};
use super::rewrite::{SUMMARY_HELP, Written};
use crate::ground::{
    ClassCounts, Found, FoundCounts, GroundPoints, RewriteOptions, Settings, Step, write_classes,
    write_stream_classes, write_text_classes,
};
use spmesh_base::error::{Error, Result};
use spmesh_base::output::{Output, create_folder};
use spmesh_base::places::check_apart;
use spmesh_base::temporary::TemporaryFile;
use spmesh_formats::detect::{SPGROUND, SPGROUND_MESH};
use spmesh_formats::ledger::check_distinct;
use spmesh_formats::source::{Filters, Input, PointFile, SourceOptions};
use spmesh_shell::batch::BatchFlags;
use spmesh_shell::progress::Progress;
use spmesh_shell::resources::{TempDirFlag, ThreadsFlag};
use spmesh_shell::text_flags::TextFlags;
use spmesh_shell::{Common, Report, StatsFlag, advise_on_memory, notice, parse_size};

const TOOL: &str = "spground";

const EXAMPLES: &str = "\
Examples:
  Every tile again, with classes; tiles may be of any size, as all of them are one set of points:
    spground tiles/*.laz --out-dir classified
  From raw tiles to a terrain model:
    spground tiles/*.laz -o ground.spm
    spdem --step 1 ground.spm -o terrain.tif
  A town with large halls, whose buildings and water are classified already:
    spground tiles/*.laz --preset urban --keep-class-of 6,7,9,18 --out-dir classified
  A night's work: bad files are left out, and what is done is skipped when it runs again:
    find tiles -name '*.laz' | spground --lof - --out-dir classified --keep-going --skip-existing
  One tile of a country, in a job of its own:
    spfinalize --plan plan.json tiles/*.laz
    spground --plan plan.json tiles/17.laz --out-dir classified
";

// Paragraphs are single lines: they are wrapped to the width of the terminal.
const NOTES: &str = "
The lowest points of cells make a raster. Disks of growing radius are pushed up below it; what they do not reach, and is \
steeper than --slope allows, is an object (the SMRF filter of Pingel and others, 2013). The cells that are left are \
triangulated, and the same is done again with heights above this surface, so hills matter less. Points that are near \
the second surface are ground: up to --threshold above it, and further where it is steep. Triangles bridge gaps up to \
about twice --reach; what lies in wider ones has class 1. docs/theory/ground.md says it \
exactly.

Classes are 2 for the ground, 7 for points more than twice as far below it, 18 for points above --max-height, and for up \
to 3 points with nothing for --noise-gap below them, 1 for all others. Records keep everything else, and their order. Classes depend on \
the set of points alone: not on how it is cut into files, on their order, on threads or on memory. Each output gets its name \
when it is complete; after a failure, only the outputs of earlier files exist.

With --keep-going, --skip-existing or --summary, a summary has a line for each file as soon as it is done: its output, \
whether it failed and why, points of each class, seconds, and what the output depends on. A file that is found to be \
damaged while it is read counts no more, and the others are read again without it.

Lengths are in metres, whatever the unit of the points, if their coordinate reference system states it. Points in degrees \
are refused. Points that get classes are read twice, so they cannot come from a pipe; those of a mesh (-o ground.spm) may: name - as the file. All tiles are needed together: a tile alone lacks what \
is around it.

Exit codes: 0 success, 1 I/O or runtime failure, or a file failed with --keep-going, 2 usage, 3 malformed or truncated \
input, 5 not enough memory, 6 input of another version of spmesh.";

/// Find which points are on the ground.
///
/// Reads LAS, LAZ or COPC files, text, or streams of points, and writes them again with classes; or reads
/// points of any format, and writes the triangulation of the ground.
#[derive(Debug, Parser)]
#[command(name = TOOL, version, after_help = format!("{EXAMPLES}{NOTES}"))]
#[command(mut_arg("out_dir", |folder| folder.help("Folder for the files with classes, which keep their names; it is \
    made if necessary")))]
#[command(mut_arg("summary", |summary| summary.help(SUMMARY_HELP)))]
#[command(mut_arg("resume", |resume| resume.help("Skip the files that an earlier run to the same folder has done with \
    the same flags, if all files are the same still by size and time")))]
#[command(mut_arg("keep_going", |keep_going| keep_going.help("Leave files that are damaged out, as if they had not \
    been given")))]
pub struct Flags {
    /// Files of points: one set
    #[arg(value_name = "FILE")]
    inputs: Vec<PathBuf>,

    /// File for the points of a single input (.las, .laz), or for the mesh of the ground of all (.spm)
    #[arg(short, long, value_name = "FILE", required_unless_present = "out_dir", conflicts_with = "out_dir")]
    output: Option<PathBuf>,

    #[command(flatten)]
    batch: BatchFlags,

    /// File for counts and parameters, as JSON
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,

    /// Whether points are compressed [default: by the extension of --output, else as in the input]
    #[arg(long, value_enum, value_name = "FORMAT")]
    format: Option<FormatFlag>,

    /// Memory for cells, triangulations and points under way; others wait in temporary files
    #[arg(long, value_name = "SIZE", value_parser = parse_size, default_value = "256M")]
    memory: u64,

    #[command(flatten)]
    threads: ThreadsFlag,

    #[command(flatten)]
    temp_dir: TempDirFlag,

    #[command(flatten)]
    plan: PlanFlags,

    #[command(flatten)]
    stats: StatsFlag,

    #[command(flatten)]
    common: Common,

    #[command(flatten)]
    points: PointFlags,

    #[command(flatten)]
    text: TextFlags,

    // The last, as its heading holds for all flags after it.
    #[command(flatten)]
    parameters: ParameterFlags,
}

/// Which points take part.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Which points")]
struct PointFlags {
    /// Points of these classes keep them, and do not count for the ground [default: 7,18]
    #[arg(long, value_name = "CLASS", value_delimiter = ',')]
    keep_class_of: Vec<u8>,

    /// Only last returns count for the ground and get classes; others keep theirs
    #[arg(long)]
    last_only: bool,

    /// Points in the overlap of swaths keep their class, and do not count for the ground
    #[arg(long)]
    drop_overlap: bool,

    /// Treat points that are marked as withheld as others; otherwise they keep their class and do not count
    #[arg(long)]
    keep_withheld: bool,
}

/// Runs the tool.
///
/// # Errors
/// As [`Found::find`]; if an input or output cannot be opened; if writing fails.
pub fn run(flags: Flags) -> anyhow::Result<()> {
    advise_on_memory(TOOL, "give less --memory, or fewer --threads");
    let started = Instant::now();
    flags.parameters.parameters().check()?;
    let around = flags.plan.around(&flags)?;
    let paths = match &around {
        Some(around) => around.files.clone(),
        None => flags.inputs()?,
    };
    if paths.is_empty() {
        flags.notice("no tile begins in this leaf: there is nothing to do");
        return Ok(());
    }
    let mesh = flags.mesh();
    let outputs = match mesh {
        Some(_) => check_distinct(&paths).map(|()| Vec::new())?,
        None => flags.names().of(&paths)?,
    };
    if let Some(around) = &around {
        around.check_outputs(&outputs)?;
    }
    // Before the check, which needs the folder to tell its files.
    if let Some(folder) = &flags.batch.out_dir {
        create_folder(folder)?;
    }
    let flag = if flags.output.is_some() { "--output" } else { "--out-dir" };
    let named = outputs.iter().map(|output| (flag, output.as_path()));
    let others = mesh.map(|path| ("--output", path)).into_iter();
    let summary = flags.batch.summary.as_deref().map(|path| ("--summary", path));
    let report = flags.report.as_deref().map(|path| ("--report", path));
    check_apart([], &named.chain(others).chain(summary).chain(report).collect::<Vec<_>>())?;
    let report = flags.report.as_deref().map(|path| Output::create(path, false)).transpose()?;
    let finished = match flags.batch.with_summary()? {
        Some(folder) => batch::run(&flags, around.as_ref(), folder, paths, outputs)?,
        None => run_plain(&flags, around.as_ref(), &paths, &outputs)?,
    };
    if let Some(mut output) = report {
        let text = format!("{:#}\n", flags.report_of(&finished));
        output.write_all(text.as_bytes()).map_err(|e| Error::io("writing the report", e))?;
        output.commit()?;
    }
    flags.stats.print(|| Report::of(started.elapsed()).counts(rows(&finished)));
    finished.failure.map_or(Ok(()), |failure| Err(failure.into()))
}

/// All of a run.
#[derive(Default)]
struct Finished {
    /// `None` if all files had been done before.
    found: Option<FoundCounts>,
    counts: ClassCounts,
    /// Files with classes.
    files: u64,
    failure: Option<Error>,
}

/// Writes the mesh, or file by file until one fails.
fn run_plain(
    flags: &Flags,
    around: Option<&Around>,
    paths: &[PathBuf],
    outputs: &[PathBuf],
) -> Result<Finished> {
    // All headers are looked at before the work begins.
    let mesh = flags.mesh();
    let files = if mesh.is_some() { Vec::new() } else { flags.files(paths, outputs)? };
    let mesh = mesh.map(|path| Output::create(path, false)).transpose()?;

    // What cannot be written is better known before the work than after it.
    TemporaryFile::create(flags.temp_dir.get())?;
    outputs.iter().try_for_each(|output| Output::create(output, true).map(drop))?;

    let inputs = around.map_or(paths, |around| &around.inputs);
    let (input, found) = flags.found(around, inputs)?;
    let mut counts = ClassCounts::default();
    if let Some(mut mesh) = mesh {
        let points = GroundPoints::new(&found, &input, flags.threads.get(), flags.memory / 4);
        flags.settings().meshing()?.write(&points, false, &mut mesh)?;
        mesh.commit()?;
        input.withheld_notice().iter().for_each(|text| flags.notice(text));
    }
    for (file, output) in files.iter().zip(outputs) {
        let written = flags.rewrite(&found, file, output)?;
        written.notices.iter().for_each(|text| flags.notice(&format!("{}: {text}", file.name())));
        counts.add(&written.counts);
    }
    Ok(Finished { found: Some(found.counts().clone()), counts, files: files.len() as u64, failure: None })
}

impl Flags {
    fn notice(&self, text: &str) {
        notice(TOOL, &self.common, text);
    }

    /// The output, if it is the mesh of the ground.
    fn mesh(&self) -> Option<&Path> {
        self.output
            .as_deref()
            .filter(|path| path.extension().is_some_and(|end| end.eq_ignore_ascii_case("spm")))
    }

    fn inputs(&self) -> Result<Vec<PathBuf>> {
        let files = self.batch.files(&self.inputs)?;
        for file in files.iter().filter(|_| self.mesh().is_none()) {
            let is_pipe = std::fs::metadata(file).is_ok_and(|found| !found.is_file() && !found.is_dir());
            if is_pipe || file.as_os_str() == "-" {
                let what = "points that get classes are read twice, so they cannot come from a pipe: give files, or \
                            write the mesh of the ground, --output NAME.spm";
                return Err(Error::usage(what).of_input(file.display().to_string()));
            }
        }
        if self.format.is_some() && self.mesh().is_some() {
            return Err(Error::usage("--format is for points: leave it out, as the output is a mesh"));
        }
        if files.len() > 1 && self.output.is_some() && self.mesh().is_none() {
            return Err(Error::usage("several files need a folder for their outputs: --out-dir FOLDER"));
        }
        Ok(files)
    }

    fn names(&self) -> OutputNames<'_> {
        OutputNames {
            output: self.output.as_deref(),
            folder: self.batch.out_dir.as_deref(),
            format: self.format,
        }
    }

    fn filters(&self) -> Filters {
        let PointFlags { keep_class_of, last_only, drop_overlap, keep_withheld } = &self.points;
        Filters {
            drop_class: keep_class_of.clone(),
            drop_noise: keep_class_of.is_empty(),
            last_only: *last_only,
            drop_overlap: *drop_overlap,
            keep_withheld: *keep_withheld,
            ..Filters::default()
        }
    }

    fn source_options(&self) -> SourceOptions {
        SourceOptions {
            reader: if self.mesh().is_some() { &SPGROUND_MESH } else { &SPGROUND },
            text: self.text.options(),
            filters: self.filters(),
            dims: 2,
            temp_dir: self.temp_dir.to_owned(),
            threads: Some(self.threads.get()),
            ..SourceOptions::default()
        }
    }

    /// Opens the files that get classes.
    fn files(&self, paths: &[PathBuf], outputs: &[PathBuf]) -> Result<Vec<PointFile>> {
        let open = |(path, output): (&PathBuf, &PathBuf)| {
            let file = PointFile::open(path, &SPGROUND, self.temp_dir.get(), &self.text.options())?;
            self.names().check(&file, output).map(|()| file)
        };
        paths.iter().zip(outputs).map(open).collect()
    }

    fn settings(&self) -> Settings {
        Settings {
            memory: self.memory,
            threads: self.threads.get().get(),
            temp_dir: self.temp_dir.to_owned(),
        }
    }

    /// What is ground of all points.
    fn found(&self, around: Option<&Around>, inputs: &[PathBuf]) -> Result<(Input, Found)> {
        let mut options = self.source_options();
        if let Some(around) = around {
            options = around.options(options);
        }
        let input = Input::open(inputs, &options)?;
        input.notices().iter().for_each(|text| self.notice(text));
        let found = self.find(&input, around)?;
        if found.counts().triangles == 0 {
            self.notice(
                "there is no ground: it takes three cells with points that are no objects, not on a line",
            );
        }
        Ok((input, found))
    }

    fn find(&self, input: &Input, around: Option<&Around>) -> Result<Found> {
        let total = input.description().stated_points;
        let mut reading = Progress::new(&self.common, "reading points", total);
        let mut opening = None;
        let mut show = |step, done| match step {
            Step::Reading => reading.set(done),
            Step::Opening => {
                let bar = || Progress::counting("blocks", &self.common, "finding the ground", None);
                opening.get_or_insert_with(bar).set(done);
            }
            Step::Surface => opening = None,
        };
        let window = around.and_then(|around| around.window.as_ref());
        Found::find(input, &self.parameters.parameters(), &self.settings(), window, &mut show)
    }

    /// Writes one file.
    fn rewrite(&self, found: &Found, file: &PointFile, output: &Path) -> Result<Written<ClassCounts>> {
        let options = RewriteOptions {
            filters: self.filters(),
            is_compressed: self.names().is_compressed(output),
            memory: self.memory / 4,
            threads: self.threads.get().get(),
        };
        let mut progress = Progress::new(&self.common, "writing points", file.stated_points());
        let (created, mut show) = (Output::create(output, true)?, |points| progress.set(points));
        let (written, of_file, notices) = match file {
            PointFile::Las(file) => write_classes(found, file, created, &options, show)?,
            PointFile::Text(file) => {
                let (written, counts) = write_text_classes(found, file, created, &options, &mut show)?;
                (written, counts, Vec::new())
            }
            PointFile::Stream(file) => {
                let (written, counts) = write_stream_classes(found, file, created, &options, &mut show)?;
                (written, counts, Vec::new())
            }
        };
        written.commit()?;
        drop(progress);
        Written::at(output, of_file, notices)
    }
}

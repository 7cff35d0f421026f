//! `spreport`: flags, and the counts of `--stats`.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Parser;

use crate::height::Ground;
use crate::report::{
    ATTRIBUTES, Accuracy, CheckOptions, Options, Report as Found, check, count, cover, window,
};
use spmesh_base::error::{Error, Result};
use spmesh_base::output::Output;
use spmesh_formats::crs::System;
use spmesh_formats::detect::SPREPORT;
use spmesh_formats::source::{
    AttributeChoice, Column, Input, LabelledPoints, SourceOptions, TextOptions, name_of, read_labelled,
};
use spmesh_shell::endings;
use spmesh_shell::progress::Progress;
use spmesh_shell::resources::{TempDirFlag, ThreadsFlag};
use spmesh_shell::stats::Row;
use spmesh_shell::text_flags::TextFlags;
use spmesh_shell::{
    Common, Mesh, MeshReader, Needs, Report, StatsFlag, advise_on_memory, notice, parse_size, peak_memory,
    read_list,
};

const TOOL: &str = "spreport";

/// Endings of pages.
const PAGE: &[&str] = &["html", "htm"];

/// Memory of a check point, with what is computed for it. Units: bytes.
const CHECK_POINT_LEN: u64 = 64;

const EXAMPLES: &str = "\
Examples:
  Density, voids, classes and flight lines of tiles, as a page:
    spreport tiles/*.laz -o report.html
  With the accuracy of a mesh of their ground at check points, also as JSON:
    spfinalize tiles/*.laz --keep-class 2 | spdelaunay2d > ground.spm
    spreport tiles/*.laz --mesh ground.spm --check checkpoints.csv --class-field cover -o report.html --json report.json
  In one pipe, with check points that were surveyed to 2 cm:
    spfinalize tiles/*.laz --keep-class 2 | spdelaunay2d | spreport tiles/*.laz --mesh - --check checkpoints.csv --check-accuracy 0.02 -o report.html
";

// Paragraphs are single lines: they are wrapped to the width of the terminal.
const NOTES: &str = "
Withheld points and points with a coordinate that is not finite are counted and left out. Points that do not say which \
return they are count as first and only ones. Columns of text called classification, point_source_id, return_number and \
number_of_returns count as the fields of LAS files do.

Density is that of first returns in cells of --cell. A void is a square of four pulse spacings without a first return in \
the extent of the points: it has points to the left, to the right, above and below. Flight lines are compared in such \
squares with three single returns of each, on slopes below 10 degrees, without vegetation, water and noise.

Differences at check points are the elevation of the mesh minus that of the check point, so they are positive where the \
mesh is too high. RMSE V1, NVA and VVA are those of the ASPRS Positional Accuracy Standards, edition 2: there is no factor \
for a confidence of 95 %. Check points with the word VVA or vegetated, or of the LAS classes 3 to 5, are in vegetation. \
Check points are text with columns x, y and z, GeoJSON, Shapefiles, GeoPackages, or points of any format that is read. \
With --check, flags of text are for check points, without it for points.

Exit codes: 0 success, 1 I/O or runtime failure, 2 usage, 3 malformed or truncated input, 5 not enough \
memory, 6 input of another version of spmesh, 141 output closed by its reader.";

/// Write a report on points, and on a mesh at check points, as a page and as JSON.
///
/// Reads points of any format twice, a triangle mesh as spdelaunay2d writes it, and check points.
#[derive(Debug, Parser)]
#[command(name = TOOL, version, after_long_help = format!("{EXAMPLES}{NOTES}"))]
pub struct Flags {
    /// Points: LAS, LAZ, COPC, text and others
    #[arg(value_name = "FILE")]
    inputs: Vec<PathBuf>,

    /// Read the paths of the files from this list, one a line; - is stdin
    #[arg(long, value_name = "LIST", conflicts_with = "inputs")]
    lof: Option<PathBuf>,

    /// File for the page; - is stdout [default: stdout, unless --json is given]
    #[arg(short, long, value_name = "HTML")]
    output: Option<PathBuf>,

    /// File for the same figures as JSON; - is stdout
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,

    /// Stream of a triangle mesh that is compared with check points; - is stdin
    #[arg(long, value_name = "STREAM", requires = "check")]
    mesh: Option<PathBuf>,

    /// File of check points
    #[arg(long, value_name = "FILE", requires = "mesh")]
    check: Option<PathBuf>,

    /// Column, property or attribute that says what is at a check point; of LAS files, it is the class by
    /// default
    #[arg(long, value_name = "NAME", requires = "check")]
    class_field: Option<Column>,

    /// Words of --class-field that stand for vegetation, beside VVA and vegetated
    #[arg(long, value_name = "WORD", value_delimiter = ',', requires = "check")]
    vegetated: Vec<String>,

    /// Root mean square error of the check points themselves, in units of z (RMSE V2)
    #[arg(long, value_name = "RMSE", requires = "check", value_parser = parse_length)]
    check_accuracy: Option<f64>,

    /// Side of the cells in which densities are counted; their corners are at its multiples. It doubles where
    /// memory is too little [default: 10]
    #[arg(long, value_name = "S", value_parser = parse_positive)]
    cell: Option<f64>,

    /// Pulse spacing that was asked for, which decides what a void is [default: the measured one, rounded up]
    #[arg(long, value_name = "LENGTH", value_parser = parse_positive)]
    spacing: Option<f64>,

    /// Memory for cells, check points and vertices of the mesh; other cells wait in temporary files
    #[arg(long, value_name = "SIZE", value_parser = parse_size, default_value = "160M")]
    memory: u64,

    #[command(flatten)]
    threads: ThreadsFlag,

    #[command(flatten)]
    temp_dir: TempDirFlag,

    #[command(flatten)]
    stats: StatsFlag,

    #[command(flatten)]
    common: Common,

    // The last, as its heading holds for all flags after it.
    #[command(flatten)]
    text: TextFlags,
}

/// Parses a length from 0 on.
fn parse_length(text: &str) -> std::result::Result<f64, String> {
    let length = text.parse().ok().filter(|length: &f64| length.is_finite() && *length >= 0.0);
    length.ok_or_else(|| format!("{text:?} is no length, expected a number from 0 on"))
}

/// Parses a length above 0.
pub(super) fn parse_positive(text: &str) -> std::result::Result<f64, String> {
    parse_length(text)
        .and_then(|length| if length > 0.0 { Ok(length) } else { Err("expected a length above 0".into()) })
}

/// Runs the tool.
///
/// # Errors
/// Those of reading points, mesh and check points, and if an input or output cannot be opened.
pub fn run(flags: Flags) -> anyhow::Result<()> {
    advise_on_memory(TOOL, "give less --memory, or fewer --threads");
    let started = Instant::now();
    let paths = flags.paths()?;
    let mut outputs = flags.outputs()?;
    let input = Input::open(&paths, &flags.source_options())?;
    input.notices().iter().for_each(|text| flags.notice(text));
    let crs = input.description().crs.clone();
    let unit_of_z = System::of(&crs).vertical_ratio().unwrap_or(1.0);
    let (mesh, accuracy) = match (&flags.mesh, &flags.check) {
        (Some(mesh), Some(check)) => {
            let (ground, accuracy) = flags.accuracy(mesh, check, unit_of_z)?;
            ground.check_system(&crs).map_err(|e| e.of_input(input.name()))?;
            (Some((ground.name().to_string(), ground.triangles())), Some(accuracy))
        }
        _ => (None, None),
    };
    let options = Options {
        cell: flags.cell,
        spacing: flags.spacing,
        unit_of_z,
        memory: flags.memory,
        temp_dir: flags.temp_dir.to_owned(),
    };
    let total = input.description().stated_points;
    let mut progress = Progress::new(&flags.common, "counting", total);
    let tally = count(&input, &options, |points| progress.set(points))?;
    drop(progress);
    let mut progress = Progress::new(&flags.common, "looking for voids", Some(tally.points));
    let (cover, overlap) = cover(&input, &tally, &options, |points| progress.set(points))?;
    drop(progress);
    let found = Found { name: input.name(), mesh, crs, tally, cover, overlap, accuracy };
    outputs.write(&found)?;
    flags.stats.print(|| Report::of(started.elapsed()).counts(counts(&found)));
    Ok(())
}

/// The files of a report.
struct Outputs {
    page: Option<Output>,
    json: Option<Output>,
}

impl Outputs {
    /// Writes both, then gives them their names.
    fn write(&mut self, found: &Found) -> Result<()> {
        let failed = |e| Error::io("writing", e);
        if let Some(page) = &mut self.page {
            page.write_all(found.page()?.as_bytes()).map_err(failed)?;
        }
        if let Some(json) = &mut self.json {
            writeln!(json, "{:#}", found.json()).map_err(failed)?;
        }
        [self.page.take(), self.json.take()].into_iter().flatten().try_for_each(Output::commit)
    }
}

impl Flags {
    fn notice(&self, text: &str) {
        notice(TOOL, &self.common, text);
    }

    fn paths(&self) -> Result<Vec<PathBuf>> {
        let paths = self.lof.as_ref().map_or_else(|| Ok(self.inputs.clone()), |list| read_list(list))?;
        if paths.is_empty() {
            return Err(Error::usage("no input: give files of points (see --help)"));
        }
        let inputs = paths.iter().chain(&self.mesh).chain(&self.lof);
        if inputs.filter(|path| path.as_os_str() == "-").count() > 1 {
            return Err(Error::usage("stdin can be one input only: give the others as files"));
        }
        Ok(paths)
    }

    fn outputs(&self) -> Result<Outputs> {
        let stdout = PathBuf::from("-");
        let page = self.output.as_ref().or_else(|| self.json.is_none().then_some(&stdout));
        page.iter().try_for_each(|path| endings::check(path, &[PAGE]))?;
        self.json.iter().try_for_each(|path| endings::check(path, &[endings::JSON]))?;
        let create = |path: Option<&PathBuf>| path.map(|path| Output::create(path, false)).transpose();
        Ok(Outputs { page: create(page)?, json: create(self.json.as_ref())? })
    }

    fn source_options(&self) -> SourceOptions {
        SourceOptions {
            text: if self.check.is_none() { self.text.options() } else { TextOptions::default() },
            attributes: AttributeChoice::Offered(ATTRIBUTES.map(str::to_string).to_vec()),
            ..self.reading()
        }
    }

    /// How any points are read.
    fn reading(&self) -> SourceOptions {
        SourceOptions {
            reader: &SPREPORT,
            skip_invalid: true,
            dims: 2,
            temp_dir: self.temp_dir.to_owned(),
            threads: Some(self.threads.get()),
            ..SourceOptions::default()
        }
    }

    /// Compares a mesh with check points, which take a quarter of the memory.
    fn accuracy(&self, mesh: &Path, check_points: &Path, unit_of_z: f64) -> Result<(Ground, Accuracy)> {
        let points = self.check_points(check_points)?;
        let needs = Needs { window: window(&points), beyond: Some("an elevation at a check point") };
        let MeshReader { mut reader, window } = Mesh::open(mesh)?.read(&needs)?;
        let mut progress = Progress::new(&self.common, "reading the mesh", reader.header().points);
        let memory = self.memory / 4 * 3;
        let ground =
            Ground::read(&mut reader, self.temp_dir.get(), memory, |vertices| progress.set(vertices))?;
        let ground = ground.within(window);
        let options =
            CheckOptions { of_survey: self.check_accuracy, vegetated: self.vegetated.clone(), unit_of_z };
        let accuracy = check(&ground, &points, name_of(check_points), &options, self.threads.get())?;
        if accuracy.outside > 0 {
            let [outside, all] = [accuracy.outside, accuracy.points];
            self.notice(&format!("{outside} of {all} check points are outside of the mesh"));
        }
        Ok((ground, accuracy))
    }

    fn check_points(&self, path: &Path) -> Result<LabelledPoints> {
        let most = usize::try_from(self.memory / 4 / CHECK_POINT_LEN).unwrap_or(usize::MAX);
        let options = SourceOptions { text: self.text.options(), skip_invalid: false, ..self.reading() };
        let points = read_labelled(path, self.class_field.as_ref(), most, &options)?;
        points.notices.iter().for_each(|text| self.notice(text));
        Ok(points)
    }
}

fn counts(found: &Found) -> [Row<u64>; 6] {
    let accuracy = found.accuracy.as_ref();
    [
        ("points", "points", found.tally.points),
        ("triangles of the mesh", "triangles", found.mesh.as_ref().map_or(0, |(_, triangles)| *triangles)),
        ("check points", "check_points", accuracy.map_or(0, |accuracy| accuracy.points)),
        (
            "check points outside of the mesh",
            "check_points_outside",
            accuracy.map_or(0, |accuracy| accuracy.outside),
        ),
        ("voids", "voids", found.cover.as_ref().map_or(0, |cover| cover.voids)),
        ("peak memory (bytes)", "peak_memory_bytes", peak_memory()),
    ]
}

//! `spheight`: flags, and the counts of `--stats`.

mod batch;

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Parser;

use super::names::{ENDINGS, FormatFlag, OutputNames};
use super::rewrite::{Rewriter, SUMMARY_HELP, Stated, Written};
use crate::height::{
    Counts, FileOptions, Ground, HeightPlace, Outside, about_below, write_heights, write_stream_heights,
    write_text_heights,
};
use spmesh_base::error::{Error, Result};
use spmesh_base::inputs;
use spmesh_base::output::{Output, create_folder};
use spmesh_base::places::check_apart;
use spmesh_formats::ledger::Outcome;
use spmesh_formats::source::PointFile;
use spmesh_shell::batch::BatchFlags;
use spmesh_shell::crs::CrsFlag;
use spmesh_shell::progress::Progress;
use spmesh_shell::resources::{TempDirFlag, ThreadsFlag};
use spmesh_shell::stats::Row;
use spmesh_shell::text_flags::TextFlags;
use spmesh_shell::{
    Common, Mesh, MeshReader, Names, Needs, Report, StatsFlag, advise_on_memory, named, notice, parse_size,
    peak_memory,
};
use spmesh_stream::Crs;
use spmesh_stream::model::bounds::Bounds;

const TOOL: &str = "spheight";

/// Name of the field by default: that of PDAL's dimension.
const NAME: &str = "HeightAboveGround";

/// The longest name of a field. Units: bytes.
const NAME_LEN_MAX: usize = 32;

const EXAMPLES: &str = "\
Examples:
  A mesh of the ground points of all tiles, then every tile again with heights:
    spfinalize tiles/*.laz --keep-class 2 | spdelaunay2d > ground.spm
    spheight --ground ground.spm tiles/*.laz --out-dir normalized
  The same in one pipe:
    spfinalize tiles/*.laz --keep-class 2 | spdelaunay2d | spheight --ground - tiles/*.laz --out-dir normalized
  Heights instead of elevations, for programs that look at z:
    spheight --ground ground.spm tile.laz --replace-z -o heights.laz
  A night's work: bad files do not stop the others, and what is done is skipped when it runs again:
    find tiles -name '*.laz' | spheight --ground ground.spm --lof - --out-dir normalized --keep-going --skip-existing
";

// Paragraphs are single lines: they are wrapped to the width of the terminal.
const NOTES: &str = "
Every record of a file is written again, in its order, with all of its fields; so are the header and the records before \
and after the points. A height is that above the triangle below or above the point: linear interpolation, rounded once \
to a step of the file's z (half away from zero). Without --replace-z, it is a new field of extra bytes of 32-bit \
integers with the scale of z. Points outside of the mesh of the ground have no height there: the field states which \
integer stands for that. With --replace-z they get the height above the nearest place of the mesh.

Lines of text are written again with one more column of heights, which have as many decimals as the elevation of the \
first point, from 3 to 9; NaN stands for no height. A line of names gets --name. \
Streams get an attribute of 64-bit numbers.

COPC files are written as LAZ: their index does not fit the new records. The ground may be larger than memory: its \
triangles wait in a temporary file (13 bytes each, 19 if coordinates are no integers), and each file is read and written once, in batches. Each output \
gets its name when it is complete. After a failure, the outputs of earlier files are complete, and there are no others.

With --keep-going, --skip-existing or --summary, a summary has a line for each file as soon as it is done: its output, \
whether it failed and why, counts of points, also of those without a height, seconds, and what the output depends on. \
--skip-existing takes what it says for done if input, ground, flags, version and output are the same still. A file that \
fails leaves no output of an earlier run.

Exit codes: 0 success, 1 I/O or runtime failure, or a file failed with --keep-going, 2 usage, 3 malformed or truncated input, 5 not enough \
memory, 6 input of another version of spmesh.";

/// Write LAS, LAZ, text and streams of points again with the heights of their points above the ground.
///
/// Reads a triangle mesh of the ground, as spdelaunay2d writes it, and LAS, LAZ or COPC files, text,
/// or streams of points.
#[derive(Debug, Parser)]
#[command(name = TOOL, version, after_help = format!("{EXAMPLES}{NOTES}"))]
#[command(mut_arg("crs", |crs| crs.help("The coordinate reference system of text, which states none: EPSG:CODE, \
    EPSG:CODE+CODE with one for heights, well-known text, or a file of it (.prj)")))]
#[command(mut_arg("out_dir", |folder| folder.help("Folder for the files with heights, which keep their names; it is \
    made if necessary")))]
#[command(mut_arg("summary", |summary| summary.help(SUMMARY_HELP)))]
pub struct Flags {
    /// LAS, LAZ, COPC or text files, or streams of points; several only with --out-dir
    #[arg(value_name = "FILE")]
    inputs: Vec<PathBuf>,

    /// Stream of the triangle mesh of the ground; - is stdin. Of a mesh in parts, only those below the points
    /// are read
    #[arg(long, value_name = "STREAM")]
    ground: PathBuf,

    /// File for the points with heights: .las or .laz, .spm for a stream, or another ending for text
    #[arg(short, long, value_name = "FILE", required_unless_present = "out_dir", conflicts_with = "out_dir")]
    output: Option<PathBuf>,

    #[command(flatten)]
    batch: BatchFlags,

    /// Write heights to z instead of a new field. The header states z from 0 on
    #[arg(long)]
    replace_z: bool,

    /// Name of the new field, at most 32 bytes
    #[arg(long, value_name = "NAME", default_value = NAME, conflicts_with = "replace_z")]
    name: String,

    /// Heights of points outside of the mesh of the ground: none, or those above its nearest place
    /// [default: no-data; with --replace-z, nearest]
    #[arg(long, value_name = "HOW")]
    #[arg(value_parser = named(OUTSIDE))]
    outside: Option<Outside>,

    /// Whether points are compressed [default: by the extension of --output, else as in the input]
    #[arg(long, value_enum, value_name = "FORMAT")]
    format: Option<FormatFlag>,

    /// Memory for points under way, and before for vertices of the ground that are not final
    #[arg(long, value_name = "SIZE", value_parser = parse_size, default_value = "160M")]
    memory: u64,

    #[command(flatten)]
    threads: ThreadsFlag,

    #[command(flatten)]
    temp_dir: TempDirFlag,

    #[command(flatten)]
    crs: CrsFlag,

    #[command(flatten)]
    stats: StatsFlag,

    #[command(flatten)]
    common: Common,

    // The last, as its heading holds for all flags after it.
    #[command(flatten)]
    text: TextFlags,
}

/// The values of `--outside`.
const OUTSIDE: Names<Outside> = &[("no-data", Outside::NoData), ("nearest", Outside::NEAREST)];

/// Sums over all files.
#[derive(Debug, Default)]
struct Sums {
    files: u64,
    points: u64,
    outside: u64,
    without: u64,
    output_bytes: u64,
}

impl Sums {
    fn add(&mut self, written: &Written<Counts>) {
        let Written { counts, bytes, .. } = written;
        self.files += 1;
        self.points += counts.points;
        self.outside += counts.outside;
        self.without += counts.without;
        self.output_bytes += bytes;
    }
}

/// All of a run.
#[derive(Default)]
struct Finished {
    sums: Sums,
    outcome: Outcome,
    triangles: u64,
    ground_bytes: u64,
    failure: Option<Error>,
}

/// Runs the tool.
///
/// # Errors
/// As [`Ground::read`] and [`write_heights`]; if an input or output cannot be opened; and if files of a batch
/// failed.
pub fn run(flags: Flags) -> anyhow::Result<()> {
    advise_on_memory(TOOL, "give less --memory, or fewer --threads");
    let started = Instant::now();
    let paths = flags.inputs()?;
    let outputs = flags.names().of(&paths)?;
    outputs.iter().take(1).try_for_each(|output| flags.options(output).map(drop))?;
    let finished = match flags.batch.with_summary()? {
        Some(folder) => batch::run(&flags, folder, paths, outputs)?,
        None => run_plain(&flags, &paths, &outputs)?,
    };
    if finished.sums.outside > 0 {
        flags.notice(&flags.about_outside(&finished.sums, finished.triangles > 0));
    }
    flags.stats.print(|| Report::of(started.elapsed()).counts(counts(&finished)));
    finished.failure.map_or(Ok(()), |failure| Err(failure.into()))
}

/// Writes file by file until one fails.
fn run_plain(flags: &Flags, paths: &[PathBuf], outputs: &[PathBuf]) -> Result<Finished> {
    // Before the check, which needs the folder to tell its files.
    if let Some(folder) = &flags.batch.out_dir {
        create_folder(folder)?;
    }
    let flag = if flags.output.is_some() { "--output" } else { "--out-dir" };
    let named: Vec<_> = outputs.iter().map(|output| (flag, output.as_path())).collect();
    check_apart([], &named)?;
    // All headers are looked at before the work begins.
    let files: Vec<PointFile> =
        paths.iter().zip(outputs).map(|(path, output)| flags.open(path, output)).collect::<Result<_>>()?;
    files.iter().flat_map(PointFile::notices).for_each(|text| flags.notice(text));
    let (ground, ground_bytes) =
        flags.ground(flags.window(&files.iter().map(Stated::by).collect::<Vec<_>>()), outputs)?;
    let total = files.iter().map(PointFile::stated_points).sum();
    let mut progress = Progress::new(&flags.common, "finding heights", total);
    let mut sums = Sums::default();
    for (file, output) in files.iter().zip(outputs) {
        let before = sums.points;
        let written = flags.rewrite(&ground, file, output, |points| progress.set(before + points))?;
        written.notices.iter().for_each(|text| flags.notice(&format!("{}: {text}", file.name())));
        sums.add(&written);
    }
    let outcome = Outcome { done: sums.files, ..Outcome::default() };
    Ok(Finished { sums, outcome, triangles: ground.triangles(), ground_bytes, failure: None })
}

impl Flags {
    fn notice(&self, text: &str) {
        notice(TOOL, &self.common, text);
    }

    fn inputs(&self) -> Result<Vec<PathBuf>> {
        let is_stdin = |path: &&PathBuf| path.as_os_str() == "-";
        let check = |files: &[PathBuf]| -> Result<()> {
            let inputs = self.batch.lof.iter().chain([&self.ground]).chain(files);
            let is_shared = inputs.filter(is_stdin).count() > 1;
            let refused = Error::usage("stdin can be one input only: give the others as files");
            if is_shared { Err(refused) } else { Ok(()) }
        };
        // Before the list is read, and of what it names.
        check(&self.inputs)?;
        let files = self.batch.files(&self.inputs)?;
        check(&files)?;
        if files.len() > 1 && self.output.is_some() {
            return Err(Error::usage("several files need a folder for their outputs: --out-dir FOLDER"));
        }
        Ok(files)
    }

    /// Reads the ground in a window, or all of it; also returns the number of bytes that were read.
    fn ground(&self, window: Option<Bounds>, outputs: &[PathBuf]) -> Result<(Ground, u64)> {
        let needs = Needs { window, beyond: Some("a height above the ground") };
        let MeshReader { mut reader, window } = Mesh::open(&self.ground)?.read(&needs)?;
        outputs.iter().try_for_each(|output| inputs::check_output(output))?;
        let mut progress = Progress::new(&self.common, "reading the ground", reader.header().points);
        let temp_dir = self.temp_dir.get();
        let ground = Ground::read(&mut reader, temp_dir, self.memory, |vertices| progress.set(vertices))?;
        Ok((ground.within(window), reader.bytes_read()))
    }

    /// The box that the headers of the files state; `None` if the ground is needed beyond it: the place
    /// nearest to a point may be anywhere.
    fn window(&self, files: &[Stated]) -> Option<Bounds> {
        if self.outside() == Outside::NEAREST {
            return None;
        }
        let stated = files.iter().filter(|file| file.points > 0).map(|file| file.bounds);
        let Bounds { min: [x, y, _], max: [max_x, max_y, _] } =
            stated.collect::<Option<Vec<Bounds>>>()?.into_iter().reduce(Bounds::union)?;
        Some(Bounds::over([x, y], [max_x, max_y]))
    }

    /// Writes one file.
    fn rewrite(
        &self,
        ground: &Ground,
        file: &PointFile,
        output: &Path,
        progress: impl FnMut(u64),
    ) -> Result<Written<Counts>> {
        let options = self.options(output)?;
        let created = Output::create(output, true)?;
        let (written, counts) = match file {
            PointFile::Las(file) => write_heights(ground, file, created, &options, progress)?,
            PointFile::Text(file) => {
                let crs = self.crs.system()?.unwrap_or(Crs::Unknown);
                write_text_heights(ground, file, &crs, created, &options, progress)?
            }
            PointFile::Stream(file) => write_stream_heights(ground, file, created, &options, progress)?,
        };
        written.commit()?;
        let notices = counts.notices.iter().cloned().chain(about_below(counts.below, counts.points));
        let notices = notices.collect();
        Written::at(output, counts, notices)
    }

    fn options(&self, output: &Path) -> Result<FileOptions> {
        if self.name.is_empty() || self.name.len() > NAME_LEN_MAX || self.name.contains(char::is_control) {
            return Err(Error::usage(format!("--name takes 1 to {NAME_LEN_MAX} bytes of text")));
        }
        let place = if self.replace_z { HeightPlace::Z } else { HeightPlace::Field(self.name.clone()) };
        if self.replace_z && self.outside() == Outside::NoData {
            return Err(Error::usage(
                "z cannot be without a value: give --outside nearest, or leave out --replace-z",
            ));
        }
        Ok(FileOptions {
            place,
            outside: self.outside(),
            is_compressed: self.names().is_compressed(output),
            memory: self.memory,
            threads: self.threads.get().get(),
        })
    }

    fn names(&self) -> OutputNames<'_> {
        OutputNames {
            output: self.output.as_deref(),
            folder: self.batch.out_dir.as_deref(),
            format: self.format,
        }
    }

    fn outside(&self) -> Outside {
        self.outside.unwrap_or(if self.replace_z { Outside::NEAREST } else { Outside::NoData })
    }

    fn about_outside(&self, sums: &Sums, has_triangles: bool) -> String {
        let points = match sums.outside {
            1 => "1 point is".to_string(),
            count => format!("{count} points are"),
        };
        let is_nearest = self.outside() == Outside::NEAREST;
        let what = match sums.without {
            _ if !has_triangles => "they have no height, as it has no triangles".to_string(),
            _ if !is_nearest => {
                "they have no height (--outside nearest gives them that above its nearest place)".to_string()
            }
            0 => "heights there are those above its nearest place".to_string(),
            far => {
                format!("heights there are those above its nearest place, but {far} are too far away for one")
            }
        };
        format!("{points} outside of the ground: {what}")
    }
}

fn counts(finished: &Finished) -> [Row<u64>; 10] {
    let Finished { sums, outcome, triangles, ground_bytes, .. } = finished;
    [
        ("ground (bytes)", "ground_bytes", *ground_bytes),
        ("triangles of the ground", "triangles", *triangles),
        ("files", "files", sums.files),
        ("files done before", "skipped", outcome.skipped),
        ("files that failed", "failed", outcome.failed),
        ("points", "points", sums.points),
        ("points outside of the ground", "outside", sums.outside),
        ("points without a height", "without_height", sums.without),
        ("output (bytes)", "output_bytes", sums.output_bytes),
        ("peak memory (bytes)", "peak_memory_bytes", peak_memory()),
    ]
}

//! `spheight`: flags, and the counts of `--stats`.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Parser, ValueEnum};

use crate::height::{Counts, FileOptions, Ground, HeightPlace, Outside, about_below, write_heights};
use spmesh_base::error::{Error, Result};
use spmesh_base::inputs;
use spmesh_base::output::{Output, create_folder};
use spmesh_base::places::check_apart;
use spmesh_formats::las::LasFile;
use spmesh_shell::progress::Progress;
use spmesh_shell::stats::Row;
use spmesh_shell::{
    Common, Mesh, MeshReader, Names, Needs, Report, StatsFlag, advise_on_memory, named, notice, of_ending,
    parse_size, parse_threads, peak_memory, read_list, threads,
};
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
";

// Paragraphs are single lines: they are wrapped to the width of the terminal.
const NOTES: &str = "
Every record of a file is written again, in its order, with all of its fields; so are the header and the records before \
and after the points. A height is that above the triangle below or above the point: linear interpolation, rounded once \
to a step of the file's z (half away from zero). Without --replace-z, it is a new field of extra bytes of 32-bit \
integers with the scale of z. Points outside of the mesh of the ground have no height there: the field states which \
integer stands for that. With --replace-z they get the height above the nearest place of the mesh.

COPC files are written as LAZ: their index does not fit the new records. The ground may be larger than memory: its \
triangles wait in a temporary file (13 bytes each, 19 if coordinates are no integers), and each file is read and written once, in batches. Each output \
gets its name when it is complete. After a failure, the outputs of earlier files are complete, and there are no others.

Exit codes: 0 success, 1 I/O or runtime failure, 2 usage, 3 malformed or truncated input, 5 not enough \
memory, 6 input of another version of spmesh.";

/// Write LAS and LAZ files again with the heights of their points above the ground.
///
/// Reads a triangle mesh of the ground, as spdelaunay2d writes it, and LAS, LAZ or COPC files.
#[derive(Debug, Parser)]
#[command(name = TOOL, version, after_help = format!("{EXAMPLES}{NOTES}"))]
pub struct Flags {
    /// LAS, LAZ or COPC files; several only with --out-dir
    #[arg(value_name = "FILE")]
    inputs: Vec<PathBuf>,

    /// Read the paths of the files from this list, one a line; - is stdin
    #[arg(long, value_name = "LIST", conflicts_with = "inputs")]
    lof: Option<PathBuf>,

    /// Stream of the triangle mesh of the ground; - is stdin. Of a mesh in parts, only those below the points
    /// are read
    #[arg(long, value_name = "STREAM")]
    ground: PathBuf,

    /// File for the points with heights: .las or .laz
    #[arg(short, long, value_name = "FILE", required_unless_present = "out_dir", conflicts_with = "out_dir")]
    output: Option<PathBuf>,

    /// Folder for the files with heights, which keep their names; it is made if necessary
    #[arg(long, value_name = "FOLDER")]
    out_dir: Option<PathBuf>,

    /// Write heights to z instead of a new field. The header states z from 0 on
    #[arg(long)]
    replace_z: bool,

    /// Name of the new field, at most 32 bytes
    #[arg(long, value_name = "NAME", default_value = NAME, conflicts_with = "replace_z")]
    name: String,

    /// Heights of points outside of the mesh of the ground: none, or those above its nearest place
    /// [default: no-data; with --replace-z, nearest]
    #[arg(long, value_name = "HOW")]
    #[arg(value_parser = named(&[("no-data", Outside::NoData), ("nearest", Outside::Nearest)]))]
    outside: Option<Outside>,

    /// Whether points are compressed [default: by the extension of --output, else as in the input]
    #[arg(long, value_enum, value_name = "FORMAT")]
    format: Option<FormatFlag>,

    /// Memory for points under way, and before for vertices of the ground that are not final
    #[arg(long, value_name = "SIZE", value_parser = parse_size, default_value = "160M")]
    memory: u64,

    /// Threads that decompress, as many that compress, and as many that find heights [default: one
    /// per core, at most 8]
    #[arg(long, value_name = "N", value_parser = parse_threads())]
    threads: Option<NonZeroUsize>,

    /// Folder for temporary files [default: the system's]
    #[arg(long, value_name = "FOLDER")]
    temp_dir: Option<PathBuf>,

    #[command(flatten)]
    stats: StatsFlag,

    #[command(flatten)]
    common: Common,
}

/// The values of `--format`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum FormatFlag {
    Las,
    Laz,
}

/// Sums over all files.
#[derive(Debug, Default)]
struct Sums {
    files: u64,
    points: u64,
    outside: u64,
    without: u64,
    output_bytes: u64,
}

/// Runs the tool.
///
/// # Errors
/// As [`Ground::read`] and [`write_heights`], and if an input or output cannot be opened.
pub fn run(flags: Flags) -> anyhow::Result<()> {
    advise_on_memory(TOOL, "give less --memory, or fewer --threads");
    let started = Instant::now();
    let paths = flags.inputs()?;
    let outputs = flags.outputs(&paths)?;
    // Before the check, which needs the folder to tell its files.
    if let Some(folder) = &flags.out_dir {
        create_folder(folder)?;
    }
    let flag = if flags.output.is_some() { "--output" } else { "--out-dir" };
    let named: Vec<_> = outputs.iter().map(|output| (flag, output.as_path())).collect();
    check_apart([], &named)?;
    // All headers are looked at before the work begins.
    let files: Vec<LasFile> = paths.iter().map(|path| flags.open(path)).collect::<Result<_>>()?;
    let needs = Needs { window: flags.window(&files), beyond: Some("a height above the ground") };
    let MeshReader { mut reader, window } = Mesh::open(&flags.ground)?.read(&needs)?;
    outputs.iter().try_for_each(|output| inputs::check_output(output))?;
    let mut progress = Progress::new(&flags.common, "reading the ground", reader.header().points);
    let ground = Ground::read(&mut reader, flags.temp_dir.as_deref(), flags.memory, |vertices| {
        progress.set(vertices)
    })?
    .within(window);
    drop(progress);
    let total = files.iter().map(LasFile::points).sum();
    let mut progress = Progress::new(&flags.common, "finding heights", Some(total));
    let mut sums = Sums::default();
    for (file, output) in files.iter().zip(&outputs) {
        let before = sums.points;
        let (counts, bytes) = flags.write(&ground, file, output, |points| progress.set(before + points))?;
        sums.files += 1;
        sums.points += counts.points;
        sums.outside += counts.outside;
        sums.without += counts.without;
        sums.output_bytes += bytes;
    }
    drop(progress);
    if sums.outside > 0 {
        flags.notice(&flags.about_outside(&sums, ground.triangles() > 0));
    }
    flags.stats.print(|| Report::of(started.elapsed()).counts(counts(&sums, &ground, reader.bytes_read())));
    Ok(())
}

impl Flags {
    fn notice(&self, text: &str) {
        notice(TOOL, &self.common, text);
    }

    fn inputs(&self) -> Result<Vec<PathBuf>> {
        let inputs = self.lof.as_ref().map_or_else(|| Ok(self.inputs.clone()), |list| read_list(list))?;
        let is_stdin = |path: &&PathBuf| path.as_os_str() == "-";
        let listed = self.lof.iter().chain([&self.ground]).chain(&inputs).filter(is_stdin).count();
        match inputs.len() {
            0 => Err(Error::usage("no input: give LAS or LAZ files (see --help)")),
            _ if listed > 1 => Err(Error::usage("stdin can be one input only: give the others as files")),
            2.. if self.output.is_some() => {
                Err(Error::usage("several files need a folder for their outputs: --out-dir FOLDER"))
            }
            _ => Ok(inputs),
        }
    }

    /// The output of each input.
    fn outputs(&self, inputs: &[PathBuf]) -> Result<Vec<PathBuf>> {
        if let Some(output) = &self.output {
            let name = output.display().to_string();
            if stem(&name, ".copc.laz").is_some() {
                let what = "COPC files are not written: give a name that ends in .laz alone";
                return Err(Error::usage(what).of_input(name));
            }
            if self.format.is_none() && of_ending(ENDINGS, output).is_none() {
                let what = "points are written to NAME.las or NAME.laz, or choose with --format";
                return Err(Error::usage(what).of_input(name));
            }
            return Ok(vec![output.clone()]);
        }
        let folder = self.out_dir.as_deref().unwrap_or(Path::new("."));
        let output = |input: &PathBuf| -> Result<PathBuf> {
            let name = input.file_name().filter(|name| *name != "-").and_then(|name| name.to_str());
            let name = name.ok_or_else(|| {
                Error::usage("has no name for its output: give --output FILE")
                    .of_input(input.display().to_string())
            })?;
            Ok(folder.join(self.output_name(name)))
        };
        inputs.iter().map(output).collect()
    }

    /// The name of the output of the file `name`.
    fn output_name(&self, name: &str) -> String {
        let name = stem(name, ".gz").unwrap_or_else(|| name.to_string());
        let name = stem(&name, ".copc.laz").map_or(name, |stem| format!("{stem}.laz"));
        let end = match self.format {
            None => return name,
            Some(FormatFlag::Las) => ".las",
            Some(FormatFlag::Laz) => ".laz",
        };
        let bare = stem(&name, ".las").or_else(|| stem(&name, ".laz")).unwrap_or(name);
        format!("{bare}{end}")
    }

    fn open(&self, input: &Path) -> Result<LasFile> {
        let file = LasFile::open(input, self.temp_dir.as_deref())?;
        file.notices().iter().for_each(|text| self.notice(text));
        Ok(file)
    }

    /// The box that the headers of the files state; `None` if the ground is needed beyond it: the place
    /// nearest to a point may be anywhere.
    fn window(&self, files: &[LasFile]) -> Option<Bounds> {
        if self.outside() == Outside::Nearest {
            return None;
        }
        let stated = files.iter().filter(|file| file.points() > 0).map(LasFile::stated_bounds);
        let Bounds { min: [x, y, _], max: [max_x, max_y, _] } =
            stated.collect::<Option<Vec<Bounds>>>()?.into_iter().reduce(Bounds::union)?;
        Some(Bounds::over([x, y], [max_x, max_y]))
    }

    /// Writes one file; returns its counts, and the bytes of the output.
    fn write(
        &self,
        ground: &Ground,
        file: &LasFile,
        output: &Path,
        progress: impl FnMut(u64),
    ) -> Result<(Counts, u64)> {
        let options = self.options(output)?;
        let created = Output::create(output, true)?;
        let (written, counts) = write_heights(ground, file, created, &options, progress)?;
        let bytes = written.bytes_written();
        written.commit()?;
        let notices = counts.notices.iter().cloned().chain(about_below(counts.below, counts.points));
        notices.for_each(|text| self.notice(&format!("{}: {text}", file.name())));
        Ok((counts, bytes))
    }

    fn options(&self, output: &Path) -> Result<FileOptions> {
        if self.name.is_empty() || self.name.len() > NAME_LEN_MAX || self.name.contains(char::is_control) {
            return Err(Error::usage(format!("--name takes 1 to {NAME_LEN_MAX} bytes of text")));
        }
        let place = if self.replace_z { HeightPlace::Z } else { HeightPlace::Field(self.name.clone()) };
        let is_named = self.output.is_some().then(|| of_ending(ENDINGS, output)).flatten();
        if self.replace_z && self.outside() == Outside::NoData {
            return Err(Error::usage(
                "z cannot be without a value: give --outside nearest, or leave out --replace-z",
            ));
        }
        Ok(FileOptions {
            place,
            outside: self.outside(),
            is_compressed: self.format.or(is_named).map(|format| format == FormatFlag::Laz),
            memory: self.memory,
            threads: threads(self.threads).get(),
        })
    }

    fn outside(&self) -> Outside {
        self.outside.unwrap_or(if self.replace_z { Outside::Nearest } else { Outside::NoData })
    }

    fn about_outside(&self, sums: &Sums, has_triangles: bool) -> String {
        let points = match sums.outside {
            1 => "1 point is".to_string(),
            count => format!("{count} points are"),
        };
        let is_nearest = self.outside() == Outside::Nearest;
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

/// A name without an ending, in whatever case; `None` if it has another one.
fn stem(name: &str, end: &str) -> Option<String> {
    let at = name.len().checked_sub(end.len())?;
    name.is_char_boundary(at).then_some(()).filter(|()| name[at..].eq_ignore_ascii_case(end))?;
    Some(name[..at].to_string())
}

/// The formats that endings of names stand for.
const ENDINGS: Names<FormatFlag> = &[("las", FormatFlag::Las), ("laz", FormatFlag::Laz)];

fn counts(sums: &Sums, ground: &Ground, ground_bytes: u64) -> [Row<u64>; 7] {
    [
        ("ground (bytes)", "ground_bytes", ground_bytes),
        ("triangles of the ground", "triangles", ground.triangles()),
        ("files", "files", sums.files),
        ("points", "points", sums.points),
        ("points outside of the ground", "outside", sums.outside),
        ("output (bytes)", "output_bytes", sums.output_bytes),
        ("peak memory (bytes)", "peak_memory_bytes", peak_memory()),
    ]
}

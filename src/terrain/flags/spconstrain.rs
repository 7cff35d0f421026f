//! `spconstrain`: flags, and the counts of `--stats`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Parser;

use crate::constrain::{CutOptions, Options, Stats, constrain};
use spmesh_base::error::{Error, Result, counted, counted_of};
use spmesh_base::output::Output;
use spmesh_base::system;
use spmesh_pipeline::flags::lines::{LineFlags, summary};
use spmesh_pipeline::lines::{self, ABOUT_FAR, Lines, Sources, Target, write_report};
use spmesh_shell::compression::Compression;
use spmesh_shell::endings;
use spmesh_shell::outline::length;
use spmesh_shell::progress::Progress;
use spmesh_shell::resources::TempDirFlag;
use spmesh_shell::stats::Row;
use spmesh_shell::{
    Common, Mesh, Needs, Report, StatsFlag, advise_on_memory, notice, parse_size, peak_memory,
};

const TOOL: &str = "spconstrain";

/// Memory for triangles that `--kill` may remove, by default. Units: bytes.
const KILL_MEMORY: u64 = 256 << 20;

const EXAMPLES: &str = "\
Examples:
  Roads as edges of the terrain, in one pipe:
    spfinalize tiles/*.laz --lines roads.geojson | spdelaunay2d | spconstrain --lines roads.geojson | spdem --step 1 -o terrain.tif
  Lines in a mesh that exists already; those without elevations take that of the surface:
    spconstrain --lines streams.gpkg terrain.spm -o constrained.spm
  The mesh inside of a boundary, without buildings, and without long edges at its border:
    spconstrain --hull boundary.geojson --holes buildings.geojson --kill 10 terrain.spm -o area.spm
  What was changed about lines that cross, touch or overlap:
    spconstrain --lines roads.shp --report changes.tsv terrain.spm -o constrained.spm
";

// Paragraphs are single lines: they are wrapped to the width of the terminal.
const NOTES: &str = "
The result is the constrained Delaunay triangulation: segments of lines are chains of edges, and all other edges are \
those of the Delaunay triangulation as far as no line is in the way. It depends neither on the order of points and lines \
nor on their directions. Lines that cross, touch or overlap get common vertices on the grid of the stream.

Vertices of lines that the mesh does not have are added. Where a line states an elevation, it counts, and \
not that of a point at the same place, also amid a segment; a vertex without one takes the elevation of the \
surface. Lines that leave the mesh end at its border; parts outside are left out, with a notice. Lines \
with elevations extend the mesh if spfinalize has them, too.

Polygons of --hull and --holes are lines, too, so the mesh ends exactly there. Where a ring leaves the \
mesh, the triangles stay whole that it divides between its last vertex inside and the border; --densify D \
makes these ways shorter than D. Points inside of holes stay vertices, without triangles. --kill removes \
triangles at edges of the border that are longer than a length, and goes on with those behind them, but \
never across lines: a concave hull. Only triangles with such an edge wait for it.

Triangles that no line changes pass at once. Memory is that of the lines, about 80 bytes a segment, and of \
the triangles that a line changes, until the last of them has come.

Exit codes: 0 success, 1 I/O or runtime failure, 2 usage, 3 malformed or truncated input, 5 not enough \
memory, 6 input of another version of spmesh, 141 output closed by its reader.";

/// Make lines edges of a triangle mesh while it streams.
///
/// Reads a triangle mesh stream, as spdelaunay2d writes it, and writes one.
#[derive(Debug, Parser)]
#[command(name = TOOL, version, after_help = format!("{EXAMPLES}{NOTES}"))]
pub struct Flags {
    /// Stream of the triangle mesh; - is stdin
    #[arg(value_name = "STREAM", default_value = "-")]
    input: PathBuf,

    /// File for the mesh; - is stdout
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,

    /// Keep only what is inside of these polygons: GeoJSON, Shapefile or GeoPackage (FILE.gpkg:LAYER for one
    /// layer). May be given several times
    #[arg(long, value_name = "FILE")]
    hull: Vec<PathBuf>,

    /// Leave out what is inside of these polygons. May be given several times
    #[arg(long, value_name = "FILE")]
    holes: Vec<PathBuf>,

    /// Remove triangles at edges of the border longer than this, until there are none
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    kill: Option<f64>,

    /// Memory for lines, for vertices that are not final, and for triangles that wait; those that --kill may
    /// remove wait in a temporary file beyond it [default: 256M for --kill, and what the rest needs]
    #[arg(long, value_name = "SIZE", value_parser = parse_size)]
    memory: Option<u64>,

    #[command(flatten)]
    temp_dir: TempDirFlag,

    #[command(flatten)]
    compression: Compression,

    #[command(flatten)]
    stats: StatsFlag,

    #[command(flatten)]
    common: Common,

    #[command(flatten)]
    lines: LineFlags,
}

/// Runs the tool.
///
/// # Errors
/// If the lines cannot be read, the input is no triangle mesh or is malformed, or writing fails.
pub fn run(flags: Flags) -> anyhow::Result<()> {
    advise_on_memory(TOOL, "give fewer lines at once");
    let started = Instant::now();
    flags.check()?;
    let report = flags.lines.create_report()?;
    let output = Output::create(&flags.output, true)?;
    let needs = Needs { window: None, beyond: Some("a mesh with lines") };
    let mut reader = Mesh::open(&flags.input)?.read(&needs)?.reader;
    let target = Target::of(reader.header());
    let sources = Sources { lines: &flags.lines.files, hull: &flags.hull, holes: &flags.holes, water: &[] };
    system::give_back_large_blocks();
    let options = lines::Options { takes_points: true, ..flags.lines.options() };
    let Lines { network, points, areas, changes, .. } =
        lines::read(&sources, &target, &options.within(flags.memory.unwrap_or(u64::MAX)))?;
    if !points.is_empty() {
        let points = counted(points.len() as u64, "point", "points");
        flags.notice(&format!(
            "{points} among the lines left out: with spfinalize --lines, they are vertices of the mesh"
        ));
    }
    changes.notices.iter().chain(summary(&changes).as_ref()).for_each(|text| flags.notice(text));
    let kill = length("--kill", flags.kill)?;
    // Half of it is for --kill.
    let memory = flags.memory.map(|memory| if kill.is_some() { memory / 2 } else { memory });
    let cut = CutOptions { kill, memory: memory.unwrap_or(KILL_MEMORY), temp_dir: flags.temp_dir.to_owned() };
    let options = Options { compress: flags.compression.of_stream(), cut, memory };
    let mut progress = Progress::new(&flags.common, "constraining", reader.header().points);
    let (output, stats) =
        constrain(&mut reader, &network, &areas, output, &options, |vertices| progress.set(vertices))?;
    drop(progress);
    let output_bytes = output.bytes_written();
    report.map_or(Ok(()), |report| write_report(report, &changes, None))?;
    output.commit()?;
    if stats.triangles[0] > 0 && stats.triangles[1] == 0 {
        flags.notice("no triangles are left: --hull, --holes or --kill leave out all of them");
    }
    if stats.open_segments > 0 {
        flags.notice(&about_open(&stats));
    }
    if stats.far > 0 {
        flags.notice(&about_far(&stats));
    }
    if stats.divided > 0 {
        flags.notice(&about_divided(&stats, flags.lines.densify));
    }
    flags
        .stats
        .print(|| Report::of(started.elapsed()).counts(counts(&stats, reader.bytes_read(), output_bytes)));
    Ok(())
}

/// The notice about segments that leave the mesh.
fn about_open(stats: &Stats) -> String {
    let is_apart = stats.open_segments == stats.segments && stats.ends == 0;
    let all = if is_apart { ", perhaps of another place or system" } else { "" };
    format!(
        "{} the mesh{all}: parts outside are no edges; {} at its border. Lines with elevations extend the mesh if \
         spfinalize --lines has them, too",
        counted_of(stats.open_segments, stats.segments, ["segment", "segments"], ["leaves", "leave"]),
        counted(stats.ends, "new vertex ends them", "new vertices end them")
    )
}

/// The notice about stated elevations.
fn about_far(stats: &Stats) -> String {
    format!(
        "{} elevations from lines that are far from the surface there. Check them; {ABOUT_FAR}",
        counted(stats.far, "vertex took", "vertices took")
    )
}

/// The notice about triangles that rings divide.
fn about_divided(stats: &Stats, densify: Option<f64>) -> String {
    let remedy = match densify {
        None => "with --densify D, rings have a vertex at least every D, and divide fewer",
        Some(_) => "a lesser --densify leaves fewer of them, and --kill removes those with long edges",
    };
    format!(
        "rings of --hull or --holes leave the mesh and divide {} whole: {remedy}",
        counted(stats.divided, "triangle on the way, which stays", "triangles on the way, which stay")
    )
}

fn counts(stats: &Stats, input_bytes: u64, output_bytes: u64) -> [Row<u64>; 19] {
    [
        ("triangles read", "triangles_read", stats.triangles[0]),
        ("triangles written", "triangles", stats.triangles[1]),
        ("triangles cut off", "removed", stats.removed),
        ("triangles that rings divide", "divided", stats.divided),
        ("triangles that waited", "waited", stats.held),
        ("most triangles waiting", "waited_max", stats.held_max),
        ("strips", "strips", stats.strips),
        ("segments", "segments", stats.segments),
        ("segments that leave the mesh", "open_segments", stats.open_segments),
        ("vertices that end lines at the border", "ends", stats.ends),
        ("segments that were cut off", "cut_segments", stats.cut_segments),
        ("line vertices in the mesh", "vertices_found", stats.found),
        ("line vertices added", "vertices_added", stats.added),
        ("elevations far from the mesh", "far", stats.far),
        ("line vertices outside", "vertices_outside", stats.outside),
        ("elevations taken from lines", "raised", stats.raised),
        ("input (bytes)", "input_bytes", input_bytes),
        ("output (bytes)", "output_bytes", output_bytes),
        ("peak memory (bytes)", "peak_memory_bytes", peak_memory()),
    ]
}

impl Flags {
    fn notice(&self, text: &str) {
        notice(TOOL, &self.common, text);
    }

    fn check(&self) -> Result<()> {
        self.lines.check(!self.hull.is_empty() || !self.holes.is_empty())?;
        let areas = self.hull.iter().chain(&self.holes).chain([&self.input]);
        let paths: Vec<&Path> = self.lines.files.iter().chain(areas).map(PathBuf::as_path).collect();
        if paths.len() == 1 && self.kill.is_none() {
            return Err(Error::usage("nothing to do: give --lines, --hull, --holes or --kill (see --help)"));
        }
        if paths.iter().filter(|path| path.as_os_str() == "-").count() > 1 {
            return Err(Error::usage("stdin can be one input only: give the lines or the mesh as a file"));
        }
        endings::check(&self.output, &[endings::STREAM])
    }
}

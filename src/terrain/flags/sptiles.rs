//! `sptiles`: flags, and the counts of `--stats`.

use std::path::PathBuf;
use std::time::Instant;

use clap::Parser;

use crate::meshing::Meshing;
use crate::tiles::{LevelStats, Options, Scheme, Target, write};
use spmesh_pipeline::reduce::Duplicates;
use spmesh_shell::crs::CrsFlag;
use spmesh_shell::progress::Progress;
use spmesh_shell::resources::{TempDirFlag, ThreadsFlag};
use spmesh_shell::{
    Common, Mesh, Names, Needs, Report, StatsFlag, advise_on_memory, named, notice, parse_size, peak_memory,
};

const TOOL: &str = "sptiles";

const EXAMPLES: &str = "\
Examples:
  Terrain for Cesium, with normals for light:
    spfinalize tiles/*.laz | spdelaunay2d -o terrain.spm
    sptiles --tolerance 0.1 --normals terrain.spm --out-dir tiles
  The same with a page, and a web server to look at it:
    sptiles --tolerance 0.1 --html terrain.spm --out-dir tiles
    python3 -m http.server --directory tiles
  The same as 3D Tiles of glTF:
    sptiles --tolerance 0.1 --to 3dtiles terrain.spm --out-dir tiles
";

// Paragraphs are single lines: they are wrapped to the width of the terminal.
const NOTES: &str = "
The folder gets LEVEL/X/Y.terrain and layer.json, or LEVEL/X/Y.glb and tileset.json. These come last: without them, \
the tiles are not complete. Viewers load them from a web server of files.

Each level has vertices of the mesh that spsimplify chooses, with a quarter of the error that viewers assume, and the \
finest one with --tolerance. A triangle that is in several tiles is cut. Tiles of a level meet without cracks: both \
sides of a border have the same points, to the last bit. There are no skirts.

The mesh needs a coordinate reference system: longitude and latitude, or a common map projection, on a datum near WGS 84. \
A notice tells of datums that differ from it by up to 2 m. Others are refused. Heights are taken as heights above \
the ellipsoid. Meshes with breaklines, hulls or holes are refused, as by spsimplify.

Exit codes: 0 success, 1 I/O or runtime failure, 2 usage, 3 malformed or truncated input, 5 not enough \
memory, 6 input of another version of spmesh, 141 output closed by its reader.";

const TARGETS: Names<Target> = &[("quantized-mesh", Target::QuantizedMesh), ("3dtiles", Target::Tiles3d)];
const SCHEMES: Names<Scheme> = &[("geographic", Scheme::Geographic), ("mercator", Scheme::Mercator)];

/// Make pyramids of tiles of terrain for viewers of the Earth.
///
/// Reads a triangle mesh stream, as spdelaunay2d writes it, and writes levels of it in tiles.
#[derive(Debug, Parser)]
#[command(name = TOOL, version, after_help = format!("{EXAMPLES}{NOTES}"))]
pub struct Flags {
    /// Stream of the triangle mesh; - is stdin
    #[arg(value_name = "STREAM", default_value = "-")]
    input: PathBuf,

    /// Folder for the tiles; it is made if necessary
    #[arg(long, value_name = "FOLDER")]
    out_dir: PathBuf,

    /// Greatest vertical distance of a vertex from the finest level, in the unit of elevations
    #[arg(long, value_name = "DISTANCE", allow_negative_numbers = true)]
    tolerance: f64,

    /// Format of the tiles
    #[arg(long, value_name = "FORMAT", value_parser = named(TARGETS), default_value = "quantized-mesh")]
    to: Target,

    /// What tiles are squares of: degrees (EPSG:4326), or Web Mercator (EPSG:3857)
    #[arg(long, value_name = "SCHEME", value_parser = named(SCHEMES), default_value = "geographic")]
    scheme: Scheme,

    /// The finest level [default: the first one that viewers assume to be as fine as --tolerance]
    #[arg(long, value_name = "LEVEL")]
    level_max: Option<u32>,

    /// Give vertices normals
    #[arg(long)]
    normals: bool,

    /// Write index.html, too, which shows the tiles of its folder and needs no other host
    #[arg(long)]
    html: bool,

    #[command(flatten)]
    crs: CrsFlag,

    /// Memory for triangulations; points and triangles wait in temporary files
    #[arg(long, value_name = "SIZE", value_parser = parse_size, default_value = "256M")]
    memory: u64,

    #[command(flatten)]
    threads: ThreadsFlag,

    #[command(flatten)]
    temp_dir: TempDirFlag,

    #[command(flatten)]
    stats: StatsFlag,

    #[command(flatten)]
    common: Common,
}

/// Runs the tool.
///
/// # Errors
/// As [`write()`]; if an input or output cannot be opened.
pub fn run(flags: Flags) -> anyhow::Result<()> {
    advise_on_memory(TOOL, "give less --memory, or fewer --threads");
    let started = Instant::now();
    // Vertices of a mesh are distinct.
    let meshing =
        Meshing::of_half(Duplicates::Error, flags.memory, flags.threads.get().get(), flags.temp_dir.get())?;
    let options = Options {
        scheme: flags.scheme,
        target: flags.to,
        tolerance: flags.tolerance,
        level_max: flags.level_max,
        has_normals: flags.normals,
        has_page: flags.html,
        crs: flags.crs.system()?,
        folder: flags.out_dir.clone(),
    };
    let needs = Needs { window: None, beyond: Some("a pyramid of tiles") };
    let mut reader = Mesh::open(&flags.input)?.read(&needs)?.reader;
    let mut progress = Progress::new(&flags.common, "making tiles", None);
    let (levels, notices) = write(&mut reader, meshing, &options, &mut |_, points| progress.set(points))?;
    drop(progress);
    for message in &notices {
        notice(TOOL, &flags.common, message);
    }
    flags.stats.print(|| report(started, &levels));
    Ok(())
}

fn report(started: Instant, levels: &[LevelStats]) -> Report {
    let of_level = |of: &LevelStats| {
        let rows = [
            (format!("vertices of level {}", of.level), "chosen", of.chosen),
            (format!("tiles of level {}", of.level), "tiles", of.tiles),
            (format!("triangles of level {}", of.level), "triangles", of.triangles),
            (format!("bytes of level {}", of.level), "bytes", of.bytes),
        ];
        Report::default().counts(rows).entry("level", of.level).entry("tolerance", of.tolerance)
    };
    let report = Report::of(started.elapsed()).parts("levels", levels.iter().map(of_level));
    report.counts([("peak memory (bytes)", "peak_memory_bytes", peak_memory())])
}

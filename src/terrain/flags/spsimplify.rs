//! `spsimplify`: flags, and the counts of `--stats`.

use std::path::PathBuf;
use std::time::Instant;

use clap::Parser;

use crate::meshing::Meshing;
use crate::simplify::{CELL_POINTS, Simplification, Stats};
use spmesh_base::error::{Error, Result};
use spmesh_base::output::{Output, create_folder};
use spmesh_base::temporary::TemporaryFile;
use spmesh_pipeline::reduce::Duplicates;
use spmesh_shell::compression::Compression;
use spmesh_shell::endings;
use spmesh_shell::progress::Progress;
use spmesh_shell::resources::{TempDirFlag, ThreadsFlag};
use spmesh_shell::{
    Common, Mesh, Needs, Report, StatsFlag, advise_on_memory, notice, parse_size, peak_memory,
};

const TOOL: &str = "spsimplify";

const EXAMPLES: &str = "\
Examples:
  As few triangles as a surface within 20 cm of all points takes:
    spfinalize tiles/*.laz | spdelaunay2d -o terrain.spm
    spsimplify --tolerance 0.2 terrain.spm -o simple.spm
  Prove that it is:
    spinfo --audit --within 0.2 --points terrain.spm simple.spm
  Levels of detail, each with the vertices of the coarser ones, in levels/1.spm and so on:
    spsimplify --levels 0.1,0.3,1,3 terrain.spm --out-dir levels
";

// Paragraphs are single lines: they are wrapped to the width of the terminal.
const NOTES: &str = "
The result is the Delaunay triangulation of some of the vertices, with their elevations. Every other vertex is at most \
--tolerance above or below it, in the unit of the elevations. The surface is compared with all of them once more \
at the end; where rounding leaves a vertex in doubt, it stays. Corners of the hull stay, too.

The vertices are chosen greedily, the farthest first, in cells of a quadtree with up to 262,144 vertices each. The result \
follows from the set of vertices: not from their order, the division into tiles, threads or memory. Of several \
--levels the coarsest is chosen first, and each finer one adds vertices to it, so it may have a few more than \
--tolerance gives.

Meshes with breaklines, hulls or holes are refused: simplify before spconstrain. Attributes are left out.

Exit codes: 0 success, 1 I/O or runtime failure, 2 usage, 3 malformed or truncated input, 5 not enough \
memory, 6 input of another version of spmesh, 141 output closed by its reader.";

/// Leave out vertices of a triangle mesh that others imply.
///
/// Reads a triangle mesh stream, as spdelaunay2d writes it, and writes one with a bound on its vertical
/// error.
#[derive(Debug, Parser)]
#[command(name = TOOL, version, after_help = format!("{EXAMPLES}{NOTES}"))]
pub struct Flags {
    /// Stream of the triangle mesh; - is stdin
    #[arg(value_name = "STREAM", default_value = "-")]
    input: PathBuf,

    /// Greatest vertical distance of a vertex from the result, in the unit of elevations
    #[arg(
        long,
        value_name = "DISTANCE",
        allow_negative_numbers = true,
        required_unless_present = "levels",
        conflicts_with = "levels"
    )]
    tolerance: Option<f64>,

    /// Several such distances, for a mesh each
    #[arg(long, value_name = "DISTANCES", value_delimiter = ',', requires = "out_dir")]
    levels: Vec<f64>,

    /// File for the mesh; - is stdout
    #[arg(short, long, value_name = "FILE", default_value = "-", conflicts_with = "levels")]
    output: PathBuf,

    /// Folder for the meshes of --levels, DISTANCE.spm; it is made if necessary
    #[arg(long, value_name = "FOLDER", requires = "levels")]
    out_dir: Option<PathBuf>,

    /// Memory for triangulations; points wait in temporary files
    #[arg(long, value_name = "SIZE", value_parser = parse_size, default_value = "256M")]
    memory: u64,

    #[command(flatten)]
    threads: ThreadsFlag,

    #[command(flatten)]
    temp_dir: TempDirFlag,

    #[command(flatten)]
    compression: Compression,

    #[command(flatten)]
    stats: StatsFlag,

    #[command(flatten)]
    common: Common,
}

/// Runs the tool.
///
/// # Errors
/// As [`Simplification`]; if an input or output cannot be opened.
pub fn run(flags: Flags) -> anyhow::Result<()> {
    advise_on_memory(TOOL, "give less --memory, or fewer --threads");
    let started = Instant::now();
    let levels = flags.levels()?;
    let meshing = flags.meshing()?;
    if let Some(folder) = &flags.out_dir {
        create_folder(folder)?;
    }
    let mut outputs =
        levels.iter().map(|(_, path)| Output::create(path, true)).collect::<Result<Vec<_>>>()?;
    // What cannot be written is better known before the work than after it.
    TemporaryFile::create(flags.temp_dir.get())?;
    let needs = Needs { window: None, beyond: Some("a simplification") };
    let mut reader = Mesh::open(&flags.input)?.read(&needs)?.reader;
    if !reader.header().attributes.is_empty() {
        notice(TOOL, &flags.common, "the attributes of the vertices are left out");
    }
    let mut progress = Progress::new(&flags.common, "reading vertices", reader.header().points);
    let mut simplification =
        Simplification::read(&mut reader, meshing, CELL_POINTS, |vertices| progress.set(vertices))?;
    drop(progress);
    let mut reports = Vec::new();
    for ((tolerance, _), mut output) in levels.iter().zip(outputs.drain(..)) {
        let mut progress = Progress::new(&flags.common, "simplifying", None);
        let stats = simplification.refine(*tolerance, &mut |_, points| progress.set(points))?;
        drop(progress);
        simplification.write(flags.compression.of_stream(), &mut output)?;
        output.commit()?;
        reports.push((*tolerance, stats));
    }
    flags.stats.print(|| report(started, &reports));
    Ok(())
}

fn report(started: Instant, levels: &[(f64, Stats)]) -> Report {
    let report = Report::of(started.elapsed());
    let Some((_, Stats { vertices, .. })) = levels.last() else { return report };
    let of_level = |(tolerance, stats): &(f64, Stats)| {
        let rows = [
            (format!("vertices within {tolerance}"), "chosen", stats.chosen),
            (format!("rounds for {tolerance}"), "rounds", stats.rounds),
        ];
        Report::default().counts(rows).entry("tolerance", *tolerance)
    };
    let report =
        report.counts([("vertices", "vertices", *vertices)]).parts("levels", levels.iter().map(of_level));
    report.counts([("peak memory (bytes)", "peak_memory_bytes", peak_memory())])
}

impl Flags {
    /// Tolerances and outputs, coarsest first.
    fn levels(&self) -> Result<Vec<(f64, PathBuf)>> {
        let given = self.tolerance.map(|tolerance| (tolerance, self.output.clone()));
        let folder = self.out_dir.clone().unwrap_or_default();
        let of_levels = self.levels.iter().map(|&level| (level, folder.join(format!("{level}.spm"))));
        let mut levels: Vec<(f64, PathBuf)> = given.into_iter().chain(of_levels).collect();
        for (level, path) in &levels {
            if !(0.0..f64::INFINITY).contains(level) {
                let flag = if self.tolerance.is_some() { "--tolerance" } else { "--levels" };
                return Err(Error::usage(format!("{flag} {level}: distances are numbers from 0 on")));
            }
            endings::check(path, &[endings::STREAM])?;
        }
        levels.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        if let Some(pair) = levels.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            return Err(Error::usage(format!("--levels has {} twice", pair[0].0)));
        }
        Ok(levels)
    }

    fn meshing(&self) -> Result<Meshing> {
        // Vertices of a mesh are distinct.
        Meshing::of_half(Duplicates::Error, self.memory, self.threads.get().get(), self.temp_dir.get())
    }
}

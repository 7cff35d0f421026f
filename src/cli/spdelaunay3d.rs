//! `spdelaunay3d`: flags.

use std::path::PathBuf;
use std::time::Instant;

use clap::Parser;

use super::progress::Progress;
use super::reduction::{Report, open_stream};
use super::{Common, StatsFormat, notice, threads};
use crate::output::Output;
use crate::reduce::{self, Duplicates, Options};
use crate::system;

const EXAMPLES: &str = "\
Examples:
  From points of space to a tetrahedral mesh, in bounded memory:
    spfinalize --octree cloud.xyz | spdelaunay3d -o cloud.spm
  Show what the run did, and prove the result:
    spfinalize --octree cloud.las | spdelaunay3d --stats -o cloud.spm
    spinfo --audit cloud.spm
  Fewer and larger cells: less is triangulated twice, with more memory:
    spfinalize --octree --cell-points 200000 cloud.xyz | spdelaunay3d -o cloud.spm

Points that fill space need little memory; of points on surfaces most wait until the end, because
the balls around their tetrahedra reach far.

Exit codes: 0 success, 1 I/O or runtime failure, 2 usage, 3 malformed or truncated input,
141 output closed by its reader.";

/// Streaming Delaunay tetrahedralization of points in space, in bounded memory.
///
/// Reads a stream of (finalized) points of three dimensions and writes a tetrahedral mesh stream. The result is exact and
/// canonical: the set of tetrahedra depends neither on the order of the points, nor on cells or threads.
#[derive(Debug, Parser)]
#[command(name = "spdelaunay3d", version, after_help = EXAMPLES)]
pub struct Flags {
    /// Stream of points; - is stdin
    #[arg(value_name = "STREAM", default_value = "-")]
    input: PathBuf,

    /// Where the mesh goes; - is stdout
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,

    /// What becomes of points that coincide
    #[arg(long, value_enum, default_value_t = DuplicatesFlag::First, value_name = "POLICY")]
    duplicates: DuplicatesFlag,

    /// Threads that triangulate; memory grows with them [default: one per core, at most 8]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,

    /// Print what the run did on stderr
    #[arg(long, value_enum, value_name = "FORMAT", num_args = 0..=1, default_missing_value = "text", require_equals = true)]
    stats: Option<StatsFormat>,

    #[command(flatten)]
    common: Common,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum DuplicatesFlag {
    /// They are one vertex
    First,
    /// They are an error
    Error,
}

impl From<DuplicatesFlag> for Duplicates {
    fn from(flag: DuplicatesFlag) -> Self {
        match flag {
            DuplicatesFlag::First => Duplicates::First,
            DuplicatesFlag::Error => Duplicates::Error,
        }
    }
}

/// Runs the tool.
///
/// # Errors
/// As [`reduce::tetrahedralize`], and if the input or the output cannot be opened.
pub fn run(flags: Flags) -> anyhow::Result<()> {
    let started = Instant::now();
    system::give_back_large_blocks();
    let reader = open_stream(&flags.input)?;
    let output = Output::create(&flags.output, true)?;
    let mut progress = Progress::new(&flags.common, "tetrahedralizing", reader.header().points);
    let threads = threads(flags.threads).get();
    let options = Options { duplicates: flags.duplicates.into(), threads, ..Options::default() };
    let (output, stats) = reduce::tetrahedralize(reader, output, &options, |points| progress.set(points))?;
    drop(progress);
    let output_bytes = output.bytes_written();
    output.commit()?;
    let seconds = started.elapsed().as_secs_f64();
    if stats.simplices == 0 {
        let reason =
            if stats.vertices < 4 { "fewer than four different points" } else { "all points in a plane" };
        notice("spdelaunay3d", &flags.common, &format!("no tetrahedra: {reason} ({} points)", stats.points));
    }
    if let Some(format) = flags.stats {
        Report { stats, output_bytes, seconds, simplices: "tetrahedra" }.print(format);
    }
    Ok(())
}

//! `spdelaunay2d`: flags and reports.

use std::path::PathBuf;
use std::time::Instant;

use clap::Parser;

use super::progress::Progress;
use super::reduction::{Report, open_stream};
use super::{Common, StatsFormat, notice, threads};
use crate::bounds::Region;
use crate::error::Error;
use crate::output::Output;
use crate::reduce::{self, Duplicates, Options, Part, Stats};

const EXAMPLES: &str = "\
Examples:
  From LAZ files to a triangle mesh, in bounded memory:
    spfinalize a.laz b.laz | spdelaunay2d -o terrain.spm
  Keep the lowest of coinciding points, and show what the run did:
    spfinalize --keep-class 2 a.laz | spdelaunay2d --duplicates lowest --stats -o ground.spm
  One tile of many, to be finished later or elsewhere:
    spfinalize a.laz b.laz | spdelaunay2d --partial --region 1000,2000,2000,3000 -o tile7.spm
    spdelaunay2d --merge tile*.spm -o whole.spm

Exit codes: 0 success, 1 I/O or runtime failure, 2 usage, 3 malformed or truncated input,
141 output closed by its reader.";

/// Streaming Delaunay triangulation of points in the plane, in bounded memory.
///
/// Reads a stream of (finalized) points and writes a triangle mesh stream. The result is exact and canonical:
/// it depends neither on the order of the points, nor on cells, tiles or threads.
#[derive(Debug, Parser)]
#[command(name = "spdelaunay2d", version, after_help = EXAMPLES)]
pub struct Flags {
    /// Stream of points, or with --merge partial meshes; - is stdin
    #[arg(value_name = "STREAM", default_value = "-")]
    inputs: Vec<PathBuf>,

    /// Where the mesh goes; - is stdout
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,

    /// Which elevation a vertex gets where points coincide in x and y
    #[arg(long, value_enum, default_value_t = DuplicatesFlag::First, value_name = "POLICY")]
    duplicates: DuplicatesFlag,

    /// Threads that triangulate; memory grows with them [default: one per core, at most 8]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,

    /// Write the final triangles of --region or --cell, and the residual for --merge
    #[arg(long)]
    partial: bool,

    /// Finish several results of --partial; with --region, into a larger partial result
    #[arg(long, conflicts_with_all = ["partial", "cell", "duplicates", "threads"])]
    merge: bool,

    /// Half-open box in world coordinates: a point on its upper sides is outside; inf is allowed
    #[arg(long, value_name = "MINX,MINY,MAXX,MAXY", allow_hyphen_values = true, value_parser = parse_region)]
    region: Option<Region>,

    /// A cell of the input's tree as the region
    #[arg(long, value_name = "LEVEL/COLUMN/ROW", conflicts_with = "region", requires = "partial", value_parser = parse_cell)]
    cell: Option<Part>,

    /// Print what the run did on stderr
    #[arg(long, value_enum, value_name = "FORMAT", num_args = 0..=1, default_missing_value = "text", require_equals = true)]
    stats: Option<StatsFormat>,

    #[command(flatten)]
    common: Common,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum DuplicatesFlag {
    /// The elevation of the point that comes first
    First,
    /// The lowest elevation
    Lowest,
    /// The highest elevation
    Highest,
    /// The mean elevation
    Mean,
    /// Coinciding points are an error
    Error,
}

impl From<DuplicatesFlag> for Duplicates {
    fn from(flag: DuplicatesFlag) -> Self {
        match flag {
            DuplicatesFlag::First => Duplicates::First,
            DuplicatesFlag::Lowest => Duplicates::Lowest,
            DuplicatesFlag::Highest => Duplicates::Highest,
            DuplicatesFlag::Mean => Duplicates::Mean,
            DuplicatesFlag::Error => Duplicates::Error,
        }
    }
}

/// Runs the tool.
///
/// # Errors
/// As [`reduce::triangulate`] and [`reduce::merge`], and if an input or the output cannot be opened.
pub fn run(flags: Flags) -> anyhow::Result<()> {
    let part = part(&flags)?;
    let started = Instant::now();
    let (output, stats) = if flags.merge { merge(&flags, part)? } else { triangulate(&flags, part)? };
    let output_bytes = output.bytes_written();
    output.commit()?;
    let seconds = started.elapsed().as_secs_f64();
    if stats.simplices == 0 && part.is_none() {
        let reason =
            if stats.vertices < 3 { "fewer than three different points" } else { "all points on a line" };
        notice("spdelaunay2d", &flags.common, &format!("no triangles: {reason} ({} points)", stats.points));
    }
    if stats.outside > 0 {
        let message =
            format!("{} of {} points lie outside of the region", stats.outside, stats.outside + stats.points);
        notice("spdelaunay2d", &flags.common, &format!("{message}: left to other regions"));
    }
    if let Some(format) = flags.stats {
        Report { stats, output_bytes, seconds, simplices: "triangles" }.print(format);
    }
    Ok(())
}

fn part(flags: &Flags) -> Result<Option<Part>, Error> {
    let part = flags.cell.or(flags.region.map(Part::Region));
    match (flags.partial, part) {
        (true, None) => {
            Err(Error::usage("--partial needs --region or --cell: the part of the plane that it is about"))
        }
        (false, Some(_)) if !flags.merge => Err(Error::usage("--region goes with --partial or --merge")),
        (_, part) => Ok(part),
    }
}

fn triangulate(flags: &Flags, part: Option<Part>) -> anyhow::Result<(Output, Stats)> {
    let [input] = &flags.inputs[..] else {
        return Err(
            Error::usage("one stream of points at a time: spfinalize joins files (or use --merge)").into()
        );
    };
    let reader = open_stream(input)?;
    let output = Output::create(&flags.output, true)?;
    let mut progress = Progress::new(&flags.common, "triangulating", reader.header().points);
    let threads = threads(flags.threads).get();
    let options = Options { duplicates: flags.duplicates.into(), threads, part, ..Options::default() };
    Ok(reduce::triangulate(reader, output, &options, |points| progress.set(points))?)
}

fn merge(flags: &Flags, part: Option<Part>) -> anyhow::Result<(Output, Stats)> {
    if flags.inputs.iter().filter(|input| input.as_os_str() == "-").count() > 1 {
        return Err(Error::usage("stdin can be given once").into());
    }
    let readers = flags.inputs.iter().map(open_stream).collect::<Result<Vec<_>, Error>>()?;
    let output = Output::create(&flags.output, true)?;
    let mut progress = Progress::new(&flags.common, "merging", None);
    Ok(reduce::merge(readers, output, part, |points| progress.set(points))?)
}

fn parse_region(text: &str) -> Result<Region, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(&[min_x, min_y, max_x, max_y]) if min_x < max_x && min_y < max_y => {
            Ok(Region { min: [min_x, min_y], max: [max_x, max_y] })
        }
        Ok(&[_, _, _, _]) => Err("the box is empty: give min x, min y, max x, max y".into()),
        _ => Err("expected four numbers separated by commas".into()),
    }
}

fn parse_cell(text: &str) -> Result<Part, String> {
    let expected = || "expected LEVEL/COLUMN/ROW, like 3/0/7".to_string();
    let parts: Vec<&str> = text.split('/').collect();
    let [level, column, row] = parts[..] else { return Err(expected()) };
    match (level.parse(), column.parse(), row.parse()) {
        (Ok(level), Ok(column), Ok(row)) => Ok(Part::Cell { level, column, row }),
        _ => Err(expected()),
    }
}

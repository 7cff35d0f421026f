//! The common part of the streaming triangulators in the plane and in space: flags, runs and messages.

mod report;

use std::io::Read;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;

use crate::reduce::{Duplicates, Options, Part, Stats, missing_region};
use spmesh_base::error::{Error, counted};
use spmesh_base::output::Output;
use spmesh_shell::compression::Compression;
use spmesh_shell::endings;
use spmesh_shell::progress::Progress;
use spmesh_shell::resources::ThreadsFlag;
use spmesh_shell::{Common, StatsFlag, advise_on_memory, notice, open_stream, parse_size};
use spmesh_stream::StreamReader;
use spmesh_stream::model::bounds::Region;

/// The flags of both triangulators.
#[derive(Debug, Args)]
pub(super) struct Shared<const D: usize> {
    /// Stream of points, or with --merge partial meshes; - is stdin
    #[arg(value_name = "STREAM", default_value = "-")]
    inputs: Vec<PathBuf>,

    /// File for the mesh; - is stdout
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,

    #[command(flatten)]
    threads: ThreadsFlag,

    /// Memory limit of the process, for points, cells and simplices: fail (exit 5) rather than exceed it
    /// [default: none]
    #[arg(long, value_name = "SIZE", value_parser = parse_size)]
    memory: Option<u64>,

    /// Write the simplices that are final in --region or --cell, and the residual for --merge
    #[arg(long)]
    partial: bool,

    /// Finish results of --partial; with --region, into a larger partial result
    #[arg(long, conflicts_with_all = ["partial", "cell", "duplicates", "threads", "memory"])]
    merge: bool,

    /// With --merge: leave out boxes that no part covers, because no points lie there
    #[arg(long, requires = "merge")]
    incomplete: bool,

    /// Half-open box in world coordinates: points on its upper sides are outside; inf is allowed
    #[arg(long, value_name = names(REGION, D), allow_hyphen_values = true, value_parser = parse_region::<D>)]
    region: Option<Region<D>>,

    /// A cell of the input's tree as the region
    #[arg(long, value_name = names(CELL, D), conflicts_with = "region", requires = "partial", value_parser = parse_cell::<D>)]
    cell: Option<Part<D>>,

    #[command(flatten)]
    compression: Compression,

    #[command(flatten)]
    stats: StatsFlag,

    #[command(flatten)]
    common: Common,
}

/// A run that held at least this many points until the end may surprise by its memory.
const MANY: u64 = 1_000_000;

/// The value name of `--region`, in the plane and in space.
const REGION: [&str; 2] = ["MINX,MINY,MAXX,MAXY", "MINX,MINY,MINZ,MAXX,MAXY,MAXZ"];

/// The value name of `--cell`, in the plane and in space.
const CELL: [&str; 2] = ["LEVEL/COLUMN/ROW", "LEVEL/COLUMN/ROW/LAYER"];

/// The value name for a number of dimensions.
const fn names(both: [&'static str; 2], dimensions: usize) -> &'static str {
    if dimensions == 2 { both[0] } else { both[1] }
}

/// The reader of an input stream.
type Reader = StreamReader<Box<dyn Read + Send>>;

/// Receives the number of points done.
type Done<'d> = dyn FnMut(u64) + Send + 'd;

/// The output, to be committed, and the counts of the run.
type Ran = Result<(Output, Stats), Error>;

/// Triangulates points.
type Reduce<const D: usize> = fn(Reader, Output, &Options<D>, &mut Done) -> Ran;

/// Merges partial meshes.
type Merge<const D: usize> = fn(Vec<Reader>, Output, &Options<D>, &mut Done) -> Ran;

/// A program of D dimensions.
pub(super) struct Tool<const D: usize> {
    pub(super) name: &'static str,
    /// The name of the pass in the progress display.
    pub(super) verb: &'static str,
    /// The name of the simplices in messages.
    pub(super) simplices: &'static str,
    /// Reasons for a mesh without simplices: too few points, or all points in fewer than D dimensions.
    pub(super) reasons: [&'static str; 2],
    pub(super) reduce: Reduce<D>,
    pub(super) merge: Merge<D>,
}

impl<const D: usize> Tool<D> {
    /// Runs the program.
    pub(super) fn run(
        &self,
        flags: &Shared<D>,
        duplicates: Duplicates,
        weighted: bool,
    ) -> anyhow::Result<()> {
        advise_on_memory(self.name, "take fewer --threads, or merge --partial meshes; see --memory");
        let part = flags.part()?;
        endings::check(&flags.output, &[endings::STREAM])?;
        let started = Instant::now();
        let options = Options { duplicates, part, weighted, ..Options::default() };
        let (output, stats) =
            if flags.merge { self.merge(flags, part)? } else { self.reduce(flags, options)? };
        let output_bytes = output.bytes_written();
        output.commit()?;
        let elapsed = started.elapsed();
        self.tell(flags, &stats, part.is_some());
        flags.stats.print(|| report::stats(&stats, output_bytes, elapsed, self.simplices));
        Ok(())
    }

    fn reduce(&self, flags: &Shared<D>, options: Options<D>) -> anyhow::Result<(Output, Stats)> {
        let [input] = &flags.inputs[..] else {
            let message = "one stream of points at a time: spfinalize joins files (or use --merge)";
            return Err(Error::usage(message).into());
        };
        let output = Output::create(&flags.output, true)?;
        let reader = open_stream(input)?;
        if reader.header().weighted.is_some() && !options.weighted {
            notice(self.name, &flags.common, "the points have weights; without --weights they are ignored");
        }
        let mut progress = Progress::new(&flags.common, self.verb, reader.header().points);
        let threads = flags.threads.get().get();
        let (memory, compress) = (flags.memory, flags.compression.of_stream());
        let options = Options { threads, memory, compress, ..options };
        Ok((self.reduce)(reader, output, &options, &mut |points| progress.set(points))?)
    }

    fn merge(&self, flags: &Shared<D>, part: Option<Part<D>>) -> anyhow::Result<(Output, Stats)> {
        if flags.inputs.iter().filter(|input| input.as_os_str() == "-").count() > 1 {
            return Err(Error::usage("stdin can be given once").into());
        }
        let output = Output::create(&flags.output, true)?;
        let readers = flags.inputs.iter().map(|path| open_stream(path)).collect::<Result<Vec<_>, Error>>()?;
        self.check_cover(flags, &readers, part)?;
        let mut progress = Progress::new(&flags.common, "merging", None);
        let options = Options { part, compress: flags.compression.of_stream(), ..Options::default() };
        Ok((self.merge)(readers, output, &options, &mut |points| progress.set(points))?)
    }

    /// Refuses parts with a gap between them, or tells of it with `--incomplete`.
    fn check_cover(&self, flags: &Shared<D>, readers: &[Reader], part: Option<Part<D>>) -> Result<(), Error> {
        let Some(Region { min, max }) = missing_region(readers, part)? else { return Ok(()) };
        let sides: Vec<String> = min.iter().chain(&max).map(f64::to_string).collect();
        let message = format!("no part covers the region {}", sides.join(","));
        if !flags.incomplete {
            let remedy = "add its part, or give --incomplete if no points lie there";
            return Err(Error::usage(format!("{message}: {remedy}")));
        }
        notice(self.name, &flags.common, &format!("{message}: left out"));
        Ok(())
    }

    /// Prints notices about results that may surprise.
    fn tell(&self, flags: &Shared<D>, stats: &Stats, is_partial: bool) {
        let say = |message: String| notice(self.name, &flags.common, &message);
        if stats.simplices == 0 && !is_partial {
            let reason = self.reasons[usize::from(stats.vertices > D as u64)];
            let points = counted(stats.points, "point", "points");
            say(format!("no {}: {reason} ({points})", self.simplices));
        }
        if stats.root_points >= MANY && 2 * stats.root_points > stats.points {
            let (waited, points) = (stats.root_points, stats.points);
            let places = if D == 2 {
                "a line or a curve do"
            } else {
                "a surface or a curve do (of points on a surface, spfinalize --octree --regions always holds fewer)"
            };
            say(format!("{waited} of {points} points waited in memory for the end, as points on {places}"));
        }
        if stats.by_order > 0 {
            let points = counted(stats.by_order, "point coincides", "points coincide");
            say(format!(
                "{points} in x and y with an earlier one that has another elevation, which stays: it depends \
                 on the order of points (with --duplicates lowest, highest or mean, it does not)"
            ));
        }
        if stats.outside > 0 {
            let points = counted(stats.outside + stats.points, "point", "points");
            let outside = stats.outside;
            say(format!("{outside} of {points} lie outside of the region: left to other regions"));
        }
    }
}

impl<const D: usize> Shared<D> {
    /// The part of a partial run, or the region of a merge.
    fn part(&self) -> Result<Option<Part<D>>, Error> {
        let part = self.cell.or(self.region.map(Part::Region));
        match (self.partial, part) {
            (true, None) => {
                let whole = if D == 2 { "the plane" } else { "space" };
                let message =
                    format!("--partial needs --region or --cell: the part of {whole} that it is about");
                Err(Error::usage(message))
            }
            (false, Some(_)) if !self.merge => Err(Error::usage("--region goes with --partial or --merge")),
            (_, part) => Ok(part),
        }
    }
}

/// Parses the D least coordinates, then the D greatest.
fn parse_region<const D: usize>(text: &str) -> Result<Region<D>, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    let sides = numbers.ok().filter(|numbers| numbers.len() == 2 * D);
    let Some(sides) = sides else {
        let count = if D == 2 { "four" } else { "six" };
        return Err(format!("expected {count} numbers separated by commas: {}", names(REGION, D)));
    };
    let region =
        Region { min: std::array::from_fn(|i| sides[i]), max: std::array::from_fn(|i| sides[D + i]) };
    if (0..D).all(|axis| region.min[axis] < region.max[axis]) {
        Ok(region)
    } else {
        Err(format!("the box is empty: give {}", names(REGION, D)))
    }
}

/// Parses a level and D indices.
fn parse_cell<const D: usize>(text: &str) -> Result<Part<D>, String> {
    let parse = || {
        let (level, places) = text.split_once('/')?;
        let at: Option<Vec<u32>> = places.split('/').map(|place| place.parse().ok()).collect();
        Some(Part::Cell { level: level.parse().ok()?, at: at?.try_into().ok()? })
    };
    parse().ok_or_else(|| {
        let example = if D == 2 { "3/0/7" } else { "3/0/7/2" };
        format!("expected {}, like {example}", names(CELL, D))
    })
}

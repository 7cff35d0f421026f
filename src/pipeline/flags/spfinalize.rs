//! `spfinalize`: flags.

mod figures;
mod groups;
mod levels;
mod planning;

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use clap::Parser;

use super::lines::{LineFlags, summary};
use super::point_filters::PointFilters;
use crate::finalize::{
    Budget, CELL_POINTS, InRegions, Leaves, Observer, Options, Order, Outcome, Pass, REGION_POINTS, Recipe,
    Spooling, WhenRegions,
};
use crate::lines::{self, write_report};
use groups::{AreaFlags, WaterFlags, WeightFlags};
use planning::PlanFlags;
use spmesh_base::error::{Error, ErrorKind, Result, counted};
use spmesh_base::output::Output;
use spmesh_base::parallel::available_threads;
use spmesh_base::system;
use spmesh_formats::detect::SPFINALIZE;
use spmesh_formats::source::{AttributeChoice, DropReason, Dropped, InvalidAdvice, RawType, SourceOptions};
use spmesh_shell::compression::Compression;
use spmesh_shell::crs::CrsFlag;
use spmesh_shell::endings;
use spmesh_shell::progress::Progress;
use spmesh_shell::resources::parse_threads;
use spmesh_shell::text_flags::TextFlags;
use spmesh_shell::{
    Common, Names, StatsFlag, advise_on_memory, named, notice, parse_numbers, parse_size, read_list,
};

const TOOL: &str = "spfinalize";

/// Most notices about files or lakes that are printed.
const NOTICES_MAX: usize = 20;

const EXAMPLES: &str = "\
Examples:
  Triangulate a tile in bounded memory:
      spfinalize tile.laz | spdelaunay2d -o tile.spm
  Ground and water of many files as one input, keeping within 256 MB:
      spfinalize --lof tiles.txt --keep-class 2,9 --memory 256M -o ground.spm
  The lowest first return of each square of half a metre, without synthetic points:
      spfinalize --first-only --drop-synthetic --thin 0.5:lowest tile.laz -o ground.spm
  One flight line, from its start to a GPS time, and how many points were dropped for which reason:
      spfinalize --keep-point-source 12,12 --keep-gps-time ,278300 --stats tile.laz -o line.spm
  A table whose comment names its columns, and the times along with the points:
      spfinalize --columns GLON,GLAT,ZG --attributes TIME ILVIS2.TXT -o lvis.spm
  What is left of a file whose transfer broke off:
      spfinalize --salvage tile.laz -o part.spm
  Files that another program lists:
      find tiles -name '*.laz' | spfinalize --lof - -o tiles.spm
  A grid of 2^6 x 2^6 cells, points in their own order, with the counts of the run:
      spfinalize --level 6 --preserve --stats text tile.laz -o tile.spm
  Intensities, classes and times of the points along with them:
      spfinalize --attributes intensity,classification,gps_time tile.laz | spdelaunay2d -o tile.spm
  Atoms with their radii, for the tetrahedra that are dual to their power diagram:
      spfinalize --octree --radii protor 1abc.cif | spdelaunay3d --weights -o 1abc.spm
  A coordinate reference system that the files state wrongly or not at all, with one for heights:
      spfinalize --crs EPSG:25832+7837 tiles/*.laz | spdelaunay2d -o ground.spm
  Points of space from compressed text:
      spfinalize --octree scan.xyz.gz | spdelaunay3d -o scan.spm
  Points and roads, whose vertices with elevations become points:
      spfinalize --keep-class 2 --lines roads.gpkg tile.laz | spdelaunay2d -o ground.spm
  A surface of contour lines, whose property ELEV states elevations, and of spot heights:
      spfinalize --no-points --lines contours.shp --lines spots.shp --z-field ELEV -o map.spm
  The points of a district, without those inside of buildings:
      spfinalize --clip district.shp --drop-inside buildings.gpkg tiles/*.laz -o district.spm
  Flat lakes and rivers that fall; the same file makes their shores edges of the mesh:
      spfinalize --flatten water.gpkg tile.laz | spdelaunay2d | spconstrain --lines water.gpkg -o flat.spm
  The levels of a whole layer of water, once, for many runs that then agree on them:
      spfinalize --flatten national.gpkg --levels water.geojson --keep-class 2 tiles/*.laz
  A plan for many jobs on a cluster, from the headers of tiles alone (see spnode):
      spfinalize --plan plan.json --keep-class 2 tiles/*.laz
  Points for another machine, at a quarter of the bytes:
      spfinalize --compress tile.laz | ssh host spdelaunay2d -o tile.spm
  Particles as floats without a header, the files of two processes as one input:
      spfinalize --octree --raw f32le rank0.bin rank1.bin -o particles.spm

Exit codes: 0 success, 1 I/O failure, 2 usage, 3 malformed input, 5 memory budget cannot be kept,
6 input of another version of spmesh, 7 complete but for points of inputs that were cut off (--salvage), 141 output closed by its reader.";

/// Finalize points: tag each cell of a quadtree or octree after the last point in it
///
/// Reads LAS, LAZ, COPC, text, spmesh streams or their text twins, SPA, SPB, arrays of numpy (.npy), the
/// vertices of PLY, OBJ or VTK (VTU, VTP, VTS or legacy), the atoms of PDB, mmCIF or XYZ of chemistry (those
/// that tess3 takes by default), or numbers without a header (--raw), all of them plain or compressed (.gz),
/// and writes a stream of points. Its tags name cells in which no later point lies. The points of a cell are
/// held back and written together (chunked), unless --preserve is given. The input is read at least twice,
/// and again if headers do not state its bounding box or if cells are crowded. Input that cannot be read
/// again is spooled, as are decoded points where that is cheaper (--spool).
#[derive(Debug, Parser)]
#[command(name = TOOL, version, after_help = EXAMPLES)]
pub struct Flags {
    /// Files to read as one input; - is stdin, and the default
    #[arg(value_name = "INPUT")]
    inputs: Vec<PathBuf>,

    /// Read the files listed in this file, one per line; - is stdin. Empty lines and lines that start with #
    /// do not count
    #[arg(long, value_name = "FILE")]
    lof: Option<PathBuf>,

    /// Read no points: the vertices of --lines are all there is
    #[arg(long, requires = "files", conflicts_with_all = ["inputs", "lof", "plan", "flatten", "octree"])]
    no_points: bool,

    /// Read files of bare numbers, x, y and z of each point: a type of i8, u8, i16, u16, i32, u32, i64,
    /// u64, f32 or f64 with its byte order, as in f32le or f64be
    #[arg(long, value_name = "TYPE")]
    raw: Option<RawType>,

    /// Of LAS, LAZ, text or raw files that were cut off, take the whole points before the cut (of LAZ, whole
    /// chunks), and exit with 7. A last line of text without a line end counts as cut
    #[arg(long)]
    salvage: bool,

    /// File for the stream; - is stdout
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,

    #[command(flatten)]
    plan: PlanFlags,

    /// Take all occupied cells of this level as leaves; with --cell-points, the deepest level of leaves. 0 is
    /// a single cell
    #[arg(long, value_name = "K")]
    level: Option<u8>,

    #[arg(long, value_name = "N", help = format!("Divide cells that hold more points than this [default: {CELL_POINTS}]"), value_parser = clap::value_parser!(u64).range(1..))]
    cell_points: Option<u64>,

    /// Keep the order of the points and only insert tags
    #[arg(long)]
    preserve: bool,

    /// With --octree: write points in overlapping regions, each of which spdelaunay3d tetrahedralizes alone.
    /// Most points on surfaces wait until the end otherwise, in memory; auto looks at a sample. About N
    /// points a region with --cell-points N
    #[arg(long, value_name = "WHEN", default_value = "auto", value_parser = named(REGIONS))]
    regions: WhenRegions,

    /// Divide space with an octree: z is geometry, not elevation
    #[arg(long)]
    octree: bool,

    /// Memory limit of the process; points beyond it wait in a temporary file (see --temp-dir)
    #[arg(long, value_name = "SIZE", default_value = "512M", value_parser = parse_size)]
    memory: u64,

    /// Folder for temporary files [default: the system's]. The default may be in RAM (tmpfs): name a folder
    /// on disk for big input without order
    #[arg(long, value_name = "FOLDER")]
    temp_dir: Option<PathBuf>,

    /// Spool decoded points to a temporary file for later passes (see --temp-dir): where decoding again would
    /// cost more and the disk has room, always, or never
    #[arg(long, value_name = "WHEN", default_value = "auto", value_parser = named(SPOOLING))]
    spool: Spooling,

    /// Threads that decode LAZ [default: one per core]; each takes a part of --memory. One more always reads
    /// ahead
    #[arg(long, value_name = "N", value_parser = parse_threads())]
    threads: Option<NonZeroUsize>,

    /// Take attributes of the points along: their names, or all that every file has
    #[arg(long, value_name = "NAMES|all", value_delimiter = ',')]
    attributes: Vec<String>,

    /// Round coordinates to a grid of these steps
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_numbers::<3>)]
    scale: Option<[f64; 3]>,

    /// World coordinates of the origin of that grid [default: 0,0,0]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_numbers::<3>, allow_hyphen_values = true, requires = "scale")]
    offset: Option<[f64; 3]>,

    #[command(flatten)]
    compression: Compression,

    #[command(flatten)]
    crs: CrsFlag,

    #[command(flatten)]
    stats: StatsFlag,

    #[command(flatten)]
    common: Common,

    #[command(flatten)]
    points: PointFilters,

    #[command(flatten)]
    areas: AreaFlags,

    #[command(flatten)]
    text: TextFlags,

    #[command(flatten)]
    lines: LineFlags,

    #[command(flatten)]
    water: WaterFlags,

    #[command(flatten)]
    weights: WeightFlags,
}

/// When points of space come in regions.
const REGIONS: Names<WhenRegions> =
    &[("auto", WhenRegions::Auto), ("always", WhenRegions::Always), ("never", WhenRegions::Never)];

/// When decoded points are kept for later passes.
const SPOOLING: Names<Spooling> =
    &[("auto", Spooling::Auto), ("always", Spooling::Always), ("never", Spooling::Never)];

/// Runs the tool.
///
/// # Errors
/// Everything that reading, finalizing and writing fail with.
pub fn run(flags: Flags) -> anyhow::Result<()> {
    advise_on_memory(TOOL, "give less --memory, or fewer --threads");
    system::give_back_large_blocks();
    flags.lines.check(!flags.water.files().is_empty())?;
    if let Some(plan) = &flags.plan.plan {
        return planning::make(&flags, plan);
    }
    if let Some(levels) = &flags.water.levels {
        return levels::write(&flags, levels);
    }
    let mut recipe = flags.recipe()?;
    // Fail before the work if the output cannot be created.
    let mut output = Output::create(&flags.output, true)?;
    recipe.inputs = flags.paths()?;
    let report = flags.lines.create_report()?;
    endings::check(&flags.output, &[endings::STREAM])?;
    let mut watch = Watch { common: &flags.common, progress: None };
    let outcome = recipe.run(&mut watch, &mut output)?;
    drop(watch);
    let Outcome { stats, dropped, lines, levels, salvaged } = outcome;
    let levels = lines.water.map(|_| &levels);
    report.map_or(Ok(()), |report| write_report(report, &lines.changes, levels))?;
    output.commit()?;
    if let Some(message) = summary(&lines.changes) {
        notice(TOOL, &flags.common, &message);
    }
    if let Some(message) = withheld_notice(&dropped.filters) {
        notice(TOOL, &flags.common, &message);
    }
    if stats.points == 0 {
        notice(TOOL, &flags.common, "no points: the input has none, or the filters keep none");
    }
    let lacking = stats.spilled_points - stats.cold_points;
    if lacking > 0 {
        let lacking = match stats.regions {
            0 => counted(lacking, "point", "points"),
            _ => counted(lacking, "copy of a point", "copies of points"),
        };
        let message = format!("{lacking} waited in a temporary file, for lack of --memory");
        notice(TOOL, &flags.common, &message);
    }
    flags.stats.print(|| figures::report(&stats, &dropped, &lines));
    if !salvaged.is_empty() {
        anyhow::bail!(Error::new(ErrorKind::Salvaged, salvaged.join("; ")));
    }
    Ok(())
}

/// The flags that a plan was made with.
pub(super) fn flags_of(arguments: &[String]) -> Result<Flags> {
    let program = std::iter::once("spfinalize".to_string());
    Flags::try_parse_from(program.chain(arguments.iter().cloned()))
        .map_err(|e| Error::malformed(format!("the arguments of the plan: {e}")))
}

impl Flags {
    /// What the flags ask for, but for the files of points.
    pub(super) fn recipe(&self) -> Result<Recipe> {
        Ok(Recipe {
            inputs: Vec::new(),
            options: self.options()?,
            weighing: self.weights.load()?,
            source: self.source_options()?,
            clip: self.areas.clip.clone(),
            drop_inside: self.areas.drop_inside.clone(),
            lines: self.lines.files.clone(),
            line_options: lines::Options { takes_points: true, ..self.lines.options() },
            flatten: self.water.flatten(),
        })
    }

    fn options(&self) -> Result<Options> {
        let leaves = match (self.level, self.cell_points) {
            (Some(level), None) => Leaves::Level(level),
            (level_max, cell_points) => {
                Leaves::Collapsed { cell_points: cell_points.unwrap_or(CELL_POINTS), level_max }
            }
        };
        Ok(Options {
            leaves,
            order: if self.preserve { Order::Preserved } else { Order::Chunked },
            budget: Budget::of_process(self.memory, self.threads().get())?,
            thin: self.points.thin,
            compress: self.compression.of_stream(),
            temp_dir: self.temp_dir.clone(),
            spooling: self.spool,
            regions: InRegions {
                when: self.regions,
                points: self.cell_points.unwrap_or(REGION_POINTS),
                threads: self.threads(),
            },
            weighted: None,
        })
    }

    fn threads(&self) -> NonZeroUsize {
        self.threads.unwrap_or_else(available_threads)
    }

    fn source_options(&self) -> Result<SourceOptions> {
        Ok(SourceOptions {
            crs: self.crs.system()?,
            reader: &SPFINALIZE,
            attributes: AttributeChoice::of_names(&self.attributes),
            filters: self.points.filters(),
            bounds: self.points.bounds,
            skip_invalid: self.points.skip_invalid,
            invalid_advice: InvalidAdvice::SkipInvalid,
            dims: if self.octree { 3 } else { 2 },
            grid: self.scale.map(|scale| (scale, self.offset.unwrap_or([0.0; 3]))),
            raw: self.raw,
            text: self.text.options(),
            salvage: self.salvage,
            temp_dir: self.temp_dir.clone(),
            threads: Some(self.threads()),
            ..SourceOptions::default()
        })
    }

    fn paths(&self) -> anyhow::Result<Vec<PathBuf>> {
        let mut paths = self.inputs.clone();
        let stdin = Path::new("-");
        if let Some(list) = &self.lof {
            paths.extend(read_list(list)?);
            if list == stdin && paths.iter().any(|path| path == stdin) {
                anyhow::bail!(Error::usage(
                    "the list of files and one of the files cannot both be stdin (-)"
                ));
            }
        } else if paths.is_empty() && !self.no_points {
            paths.push(PathBuf::from("-"));
        }
        let beside = self.beside().filter(|path| *path == stdin).count();
        let others = paths.iter().chain(&self.lof).filter(|path| *path == stdin).count();
        if beside > 1 || (beside == 1 && others > 0) {
            let message = "stdin (-) can be only one of points, lines, polygons and the list of files";
            anyhow::bail!(Error::usage(message));
        }
        Ok(paths)
    }

    /// Prints the first of many notices, and how many more there are.
    fn notice_some(&self, notices: &[String]) {
        notices.iter().take(NOTICES_MAX).for_each(|message| notice(TOOL, &self.common, message));
        if notices.len() > NOTICES_MAX {
            let more = counted((notices.len() - NOTICES_MAX) as u64, "more notice", "more notices");
            notice(TOOL, &self.common, &format!("{more} like these"));
        }
    }

    /// Files beside those of points.
    fn beside(&self) -> impl Iterator<Item = &PathBuf> {
        self.lines.files.iter().chain(self.areas.files()).chain(self.water.files())
    }
}

/// Shows progress and notices on stderr.
struct Watch<'a> {
    common: &'a Common,
    progress: Option<Progress>,
}

impl Observer for Watch<'_> {
    fn pass(&mut self, pass: Pass, total: Option<u64>) {
        self.progress = None;
        let start = if pass.is_output() { Progress::new } else { Progress::before_output };
        self.progress = Some(start(self.common, pass.name(), total));
    }

    fn done(&mut self, points: u64) {
        if let Some(progress) = &mut self.progress {
            progress.set(points);
        }
    }

    fn notice(&mut self, message: &str) {
        notice(TOOL, self.common, message);
    }
}

fn withheld_notice(dropped: &Dropped) -> Option<String> {
    let count = dropped.of(DropReason::Withheld);
    let points = if count == 1 { "point" } else { "points" };
    (count > 0).then(|| format!("{count} withheld {points} dropped; --keep-withheld keeps them"))
}

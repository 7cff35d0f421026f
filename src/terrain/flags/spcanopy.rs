//! `spcanopy`: flags, and the counts of `--stats`.

use std::path::PathBuf;
use std::time::Instant;

use clap::Parser;

use super::sheets::SheetFlags;
use crate::canopy::{Settings, draw, thresholds};
use crate::dem::{Method, Options, Quantity, Sample};
use crate::height::{Ground, HeightPoints, Surface, about_below};
use crate::meshing::Meshing;
use spmesh_base::error::{Error, Result, counted};
use spmesh_formats::detect::SPCANOPY;
use spmesh_formats::raster::{Grid, RasterFormat, Window};
use spmesh_formats::source::{Filters, Input, SourceOptions};
use spmesh_pipeline::reduce::Duplicates;
use spmesh_shell::cells::{self, CellFlags, RasterFlags};
use spmesh_shell::endings;
use spmesh_shell::outline::{OutlineFlags, length};
use spmesh_shell::progress::Progress;
use spmesh_shell::resources::ThreadsFlag;
use spmesh_shell::stats::Row;
use spmesh_shell::{
    Common, Mesh, MeshReader, Needs, Report, StatsFlag, advise_on_memory, notice, of_ending, parse_size,
    peak_memory, read_list,
};
use spmesh_stream::Crs;
use spmesh_stream::model::bounds::Bounds;

const TOOL: &str = "spcanopy";

/// The longest edge of upper layers, in cells.
const EDGE_CELLS: f64 = 4.0;

const EXAMPLES: &str = "\
Examples:
  The height of the canopy above the ground, in cells of half a metre:
    spfinalize tiles/*.laz --keep-class 2 | spdelaunay2d > ground.spm
    spcanopy --ground ground.spm tiles/*.laz --step 0.5 -o canopy.tif
  The same in one pipe:
    spfinalize tiles/*.laz --keep-class 2 | spdelaunay2d | spcanopy --ground - tiles/*.laz --step 0.5 -o canopy.tif
  A surface model in elevations, without pits and without birds:
    spcanopy --ground ground.spm tiles/*.laz --elevations --max-height 60 --step 0.5 -o surface.tif
  Only vegetation, with layers of one's own:
    spcanopy --ground ground.spm tiles/*.laz --keep-class 2,3,4,5 --layers 0,3,6,12,18 --step 1 -o canopy.tif
";

// Paragraphs are single lines: they are wrapped to the width of the terminal.
const NOTES: &str = "
First returns that reach far into a crown make pits in a surface through all of them. So the canopy is the highest of \
several surfaces (Khosravipour and others, 2014): a triangulation of all first returns, and one of those above 2 m, 5 m, \
10 m, 15 m and so on. The upper ones leave out triangles with an edge longer than --max-edge, so they cover single crowns \
only. All are exact Delaunay triangulations and are streamed, so tiles have no seams.

Heights are those above the ground at each point; below zero, they are zero. With --elevations, points keep their elevation, \
and heights only say in which layers they are: so the surface has no pits, and stands on the ground. Points outside of the ground are left out. \
Withheld points and noise (classes 7 and 18) are dropped, unless flags say which classes to keep or drop.

Exit codes: 0 success, 1 I/O or runtime failure, 2 usage, 3 malformed or truncated input, 5 not enough \
memory, 6 input of another version of spmesh, 141 output closed by its reader.";

/// Write the height of a canopy above the ground as a raster, without pits.
///
/// Reads LAS, LAZ or COPC files and a triangle mesh of the ground, as spdelaunay2d writes it. Writes a
/// GeoTIFF or an ESRI grid.
#[derive(Debug, Parser)]
#[command(name = TOOL, version, after_help = format!("{EXAMPLES}{NOTES}"))]
pub struct Flags {
    /// LAS, LAZ or COPC files
    #[arg(value_name = "FILE")]
    inputs: Vec<PathBuf>,

    /// Read the paths of the files from this list, one a line; - is stdin
    #[arg(long, value_name = "LIST", conflicts_with = "inputs")]
    lof: Option<PathBuf>,

    /// Stream of the triangle mesh of the ground; - is stdin. Of a mesh in parts, only those below the points
    /// are read
    #[arg(long, value_name = "STREAM")]
    ground: PathBuf,

    /// File for the raster; - is stdout
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,

    /// Heights from which a surface of its own is made [default: 0,2,5,10,15 and so on]
    #[arg(long, value_name = "HEIGHTS", value_delimiter = ',', allow_negative_numbers = true)]
    layers: Vec<f64>,

    /// Longest edge of triangles in layers above 0 [default: four cells]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    max_edge: Option<f64>,

    /// Write elevations of the canopy, and not its heights above the ground: a surface model without pits
    #[arg(long)]
    elevations: bool,

    /// Leave out points that are higher above the ground: birds and clouds
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    max_height: Option<f64>,

    /// Take all returns, not only the first
    #[arg(long)]
    all_returns: bool,

    /// Take only points of these classes
    #[arg(long, value_name = "CLASS", value_delimiter = ',')]
    keep_class: Vec<u8>,

    /// Leave out points of these classes [default: 7 and 18, which are noise, if no classes are kept]
    #[arg(long, value_name = "CLASS", value_delimiter = ',')]
    drop_class: Vec<u8>,

    /// Take points that are marked as withheld
    #[arg(long)]
    keep_withheld: bool,

    #[command(flatten)]
    outline: OutlineFlags,

    /// Memory for points and tiles; others wait in temporary files (see --temp-dir)
    #[arg(long, value_name = "SIZE", value_parser = parse_size, default_value = "256M")]
    memory: u64,

    #[command(flatten)]
    threads: ThreadsFlag,

    #[command(flatten)]
    stats: StatsFlag,

    #[command(flatten)]
    common: Common,

    #[command(flatten)]
    cells: CellFlags,

    #[command(flatten)]
    sheets: SheetFlags,

    #[command(flatten)]
    raster: RasterFlags,
}

/// Runs the tool.
///
/// # Errors
/// Those of all passes, and if an input or the output cannot be opened.
pub fn run(flags: Flags) -> anyhow::Result<()> {
    advise_on_memory(TOOL, "give less --memory, or fewer --threads");
    let started = Instant::now();
    let paths = flags.lof.as_ref().map_or_else(|| Ok(flags.inputs.clone()), |list| read_list(list))?;
    if paths.is_empty() {
        anyhow::bail!(Error::usage("no input: give LAS or LAZ files (see --help)"));
    }
    endings::check(&flags.output, &[endings::RASTER])?;
    let format = of_ending(cells::ENDINGS, &flags.output).unwrap_or_default();
    let mut output = flags.sheets.create(&flags.output, format, &flags.cells, &flags.raster)?;
    let input = Input::open(&paths, &flags.source_options()?)?;
    input.notices().iter().for_each(|text| flags.notice(text));
    let grid = flags.cells.grid(&input.description().crs, || window(&input))?;
    let mut bottom = flags.surface_options(format)?;
    let settings = flags.settings(&grid)?;

    let stated = window(&input).ok().map(|Window { min, max }| Bounds::over(min, max));
    let needs = Needs { window: stated, beyond: Some("a height above the ground") };
    let MeshReader { mut reader, window } = Mesh::open(&flags.ground)?.read(&needs)?;
    let mut progress = Progress::new(&flags.common, "reading the ground", reader.header().points);
    let temp_dir = flags.raster.temp_dir();
    let ground = Ground::read(&mut reader, temp_dir, flags.memory, |vertices| progress.set(vertices))?;
    let ground = ground.within(window);
    flags.check_systems(&ground, &input)?;
    // The system of the ground stands in where points state none.
    let crs = &input.description().crs;
    let crs = if *crs == Crs::Unknown { &reader.header().crs } else { crs };
    bottom.mask = flags.outline.mask(crs, Some(flags.memory), |text| flags.notice(text))?;
    let total = input.description().stated_points;
    let mut progress = Progress::new(&flags.common, "finding heights", total);
    let surface = flags.surface()?;
    let points = HeightPoints::read(&ground, &input, surface, temp_dir, flags.threads.get(), |points| {
        progress.set(points);
    })?;
    drop(ground);
    let thresholds = thresholds(&flags.layers, points.greatest())?;
    let mut progress = Progress::counting("layers", &flags.common, "drawing", Some(thresholds.len() as u64));
    let (highest, triangles) =
        draw(&points, &grid, &bottom, &settings, &thresholds, |done| progress.set(done))?;
    drop(progress);
    let crs = &input.description().crs;
    let (known, notices) = highest.write(output.destination(), &bottom, crs, surface.has_elevations)?;
    let committed = output.commit(&input.description().crs)?;
    notices.iter().for_each(|text| flags.notice(text));
    let found = points.counts();
    for (count, what) in [(found.outside, "outside of the ground"), (found.high, "above --max-height")] {
        if count > 0 {
            let points = counted(count, "point", "points");
            flags.notice(&format!("{points} {what} left out"));
        }
    }
    let below = about_below(found.below, found.points);
    below.iter().for_each(|text| flags.notice(text));
    flags.notice(&cells::summary(&grid, grid.cells() - known));
    committed.notice().iter().for_each(|text| flags.notice(text));
    let counts = || -> [Row<u64>; 9] {
        [
            ("points", "points", found.points),
            ("points outside of the ground", "outside", found.outside),
            ("points that are too high", "high", found.high),
            ("layers", "layers", thresholds.len() as u64),
            ("triangles of all layers", "triangles", triangles),
            ("cells", "cells", grid.cells()),
            ("cells with data", "known", known),
            ("output (bytes)", "output_bytes", committed.bytes),
            ("peak memory (bytes)", "peak_memory_bytes", peak_memory()),
        ]
    };
    flags.stats.print(|| Report::of(started.elapsed()).counts(counts()));
    Ok(())
}

/// The window that the headers of an input state.
fn window(input: &Input) -> Result<Window> {
    let description = input.description();
    let Some(bounds) = description.stated_bounds else {
        return Err(Error::usage("the headers do not say where the points are: give --bounds"));
    };
    let [min, max] = [bounds.min, bounds.max].map(|corner| {
        let [x, y, _] = description.coordinates.to_world(corner);
        [x, y]
    });
    Ok(Window { min, max })
}

impl Flags {
    fn notice(&self, text: &str) {
        notice(TOOL, &self.common, text);
    }

    fn source_options(&self) -> Result<SourceOptions> {
        let is_default = self.keep_class.is_empty() && self.drop_class.is_empty();
        let filters = Filters {
            keep_withheld: self.keep_withheld,
            first_only: !self.all_returns,
            keep_class: self.keep_class.clone(),
            drop_class: self.drop_class.clone(),
            drop_noise: is_default,
            ..Filters::default()
        };
        Ok(SourceOptions {
            reader: &SPCANOPY,
            filters,
            dims: 2,
            temp_dir: self.raster.temp_dir().map(Into::into),
            threads: Some(self.threads.get()),
            ..SourceOptions::default()
        })
    }

    /// How the lowest surface is drawn, and the raster is written.
    fn surface_options(&self, format: RasterFormat) -> Result<Options> {
        Ok(Options {
            quantity: Quantity::Elevation,
            sample: Sample::Centre,
            method: Method::Triangle,
            z_factor: None,
            kill: self.outline.kill()?,
            concave: self.outline.concave()?,
            mask: None,
            fill: None,
            memory: self.memory / 2,
            natural: false,
            vertices_memory: None,
            banks: None,
            raster: self.raster.options(format)?,
            crs: None,
        })
    }

    /// How layers are made. Half of the memory is for points, half for tiles.
    fn settings(&self, grid: &Grid) -> Result<Settings> {
        let (threads, temp_dir) = (self.threads.get().get(), self.raster.temp_dir());
        let meshing = Meshing::of_half(Duplicates::Highest, self.memory, threads, temp_dir)?;
        let edge_max = length("--max-edge", self.max_edge)?.unwrap_or(EDGE_CELLS * grid.step);
        Ok(Settings { edge_max, meshing })
    }

    fn surface(&self) -> Result<Surface> {
        let highest = length("--max-height", self.max_height)?.unwrap_or(f64::INFINITY);
        Ok(Surface { has_elevations: self.elevations, highest })
    }

    /// Refuses points in another coordinate reference system than the ground's.
    fn check_systems(&self, ground: &Ground, input: &Input) -> Result<()> {
        ground.check_system(&input.description().crs).map_err(|e| e.of_input(input.name()))
    }
}

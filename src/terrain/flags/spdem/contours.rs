//! `spdem --contours`: flags, and the counts of `--stats`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;

use crate::contours::{self, Levels, LineFormat, Options, Stats};
use spmesh_base::error::{Result, counted};
use spmesh_base::output::Output;
use spmesh_formats::source::epsg_code;
use spmesh_shell::outline::{OutlineFlags, length};
use spmesh_shell::progress::Progress;
use spmesh_shell::stats::Row;
use spmesh_shell::{Common, Mesh, Names, Needs, Report, StatsFlag, peak_memory};
use spmesh_stream::Crs;

/// The advice when memory runs out.
pub(super) const LACK_OF_MEMORY: &str =
    "take a larger distance for --contours, or cut lines with --contour-points";

/// Flags about contour lines.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Contour lines")]
pub(super) struct ContourFlags {
    /// Write contour lines instead of a raster, at multiples of this elevation
    #[arg(
        long,
        value_name = "D",
        allow_negative_numbers = true,
        conflicts_with_all = ["CellFlags", "SheetFlags", "no_data", "cog", "temp_dir", "GeoTiffFlags", "kind", "method", "z_factor", "light", "multidirectional", "range", "fill"]
    )]
    contours: Option<f64>,

    /// Start the multiples at this elevation
    #[arg(
        long,
        value_name = "B",
        default_value_t = 0.0,
        allow_negative_numbers = true,
        requires = "contours"
    )]
    contour_base: f64,

    /// Cut open lines with this many points, to bound memory
    #[arg(
        long,
        value_name = "N",
        value_parser = clap::value_parser!(u32).range(2..),
        requires = "contours"
    )]
    contour_points: Option<u32>,

    /// Drop lines shorter than this, open or closed
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, requires = "contours")]
    min_length: Option<f64>,

    /// Mark every N-th line from the base with the property index
    #[arg(
        long,
        value_name = "N",
        default_value_t = 5,
        value_parser = clap::value_parser!(u32).range(1..),
        requires = "contours"
    )]
    index: u32,

    /// Smooth lines; they never cross
    #[arg(long, requires = "contours")]
    smooth: bool,
}

impl ContourFlags {
    /// The lines to write, if any. Half of the memory is for triangles that wait for the outline, if there is
    /// one.
    pub(super) fn options(
        &self,
        outline: &OutlineFlags,
        memory: Option<u64>,
        crs: Option<Crs>,
    ) -> Result<Option<Options>> {
        let Some(interval) = self.contours else { return Ok(None) };
        let defaults = Options::new(Levels::new(interval, self.contour_base)?);
        let concave = outline.concave()?;
        let for_outline =
            if concave.is_some() { memory.map_or(defaults.memory, |memory| memory / 2) } else { 0 };
        Ok(Some(Options {
            kill: outline.kill()?,
            concave,
            memory: for_outline,
            lines_memory: memory.map(|memory| memory - for_outline),
            points: self.contour_points.map(|points| points as usize),
            min_length: length("--min-length", self.min_length)?,
            index: self.index,
            is_smooth: self.smooth,
            crs,
            ..defaults
        }))
    }
}

/// The formats of lines that endings of names stand for.
pub(super) const ENDINGS: Names<LineFormat> = &[
    ("geojson", LineFormat::GeoJson),
    ("json", LineFormat::GeoJson),
    ("geojsonl", LineFormat::GeoJsonLines),
    ("ndjson", LineFormat::GeoJsonLines),
];

/// A run that writes lines instead of a raster.
pub(super) struct Job<'a> {
    pub(super) input: &'a PathBuf,
    pub(super) output: &'a Path,
    pub(super) format: LineFormat,
    pub(super) outline: &'a OutlineFlags,
    /// As asked for.
    pub(super) memory: Option<u64>,
    pub(super) stats: StatsFlag,
    pub(super) common: &'a Common,
}

/// Writes lines, and calls `notice` with what the user should know of them.
pub(super) fn run(
    job: &Job,
    mut options: Options,
    started: Instant,
    notice: impl Fn(&str),
) -> anyhow::Result<()> {
    let mut output = Output::create(job.output, false)?;
    let mesh = Mesh::open(job.input)?;
    let crs = options.crs.as_ref().unwrap_or(&mesh.header().crs);
    options.mask = job.outline.mask(crs, job.memory, &notice)?;
    let needs = Needs { window: options.window(), beyond: Some("a contour line") };
    let mut reader = mesh.read(&needs)?.reader;
    let mut progress = Progress::new(job.common, "contouring", reader.header().points);
    let stats = contours::contour(&mut reader, &mut output, job.format, &options, |done| progress.set(done))?;
    drop(progress);
    let output_bytes = output.bytes_written();
    output.commit()?;
    for message in
        [summary(&stats), about_crs(job.format, options.crs.as_ref().unwrap_or(&reader.header().crs))]
    {
        notice(&message);
    }
    job.stats.print(|| Report::of(started.elapsed()).counts(counts(&stats, output_bytes)));
    Ok(())
}

/// The counts of the written lines, for a notice.
fn summary(stats: &Stats) -> String {
    match stats.elevations {
        _ if stats.triangles == 0 => "no lines: there are no triangles".to_string(),
        _ if stats.lines == 0 && stats.short > 0 => {
            format!("no lines: all {} are shorter than --min-length", stats.short)
        }
        Some([least, greatest]) if stats.lines == 0 => {
            format!("no lines: elevations are from {least} to {greatest}")
        }
        _ => format!(
            "{} ({}) at {}",
            counted(stats.lines, "line", "lines"),
            counted(stats.rings, "ring", "rings"),
            counted(stats.levels, "level", "levels")
        ),
    }
}

/// What the file tells other programs about its coordinates, for a notice.
fn about_crs(format: LineFormat, crs: &Crs) -> String {
    match (format, epsg_code(crs)) {
        (LineFormat::GeoJson, Some(code)) => {
            format!("coordinates are those of EPSG:{code}, which the file states")
        }
        (LineFormat::GeoJsonLines, Some(code)) => {
            format!(
                "coordinates are those of EPSG:{code}, which the format has no room for: say -a_srs EPSG:{code}"
            )
        }
        (_, None) => "the stream states no EPSG code: programs will take coordinates for degrees".to_string(),
    }
}

fn counts(stats: &Stats, output_bytes: u64) -> [Row<u64>; 18] {
    [
        ("input (bytes)", "input_bytes", stats.input_bytes),
        ("vertices", "vertices", stats.vertices),
        ("triangles", "triangles", stats.triangles),
        ("triangles with a long edge", "killed", stats.killed),
        ("triangles outside of the outline", "outside", stats.outside),
        ("width (live vertices)", "width", stats.width),
        ("levels with lines", "levels", stats.levels),
        ("lines", "lines", stats.lines),
        ("lines that are rings", "rings", stats.rings),
        ("lines around lower ground", "depressions", stats.depressions),
        ("points of lines", "points", stats.points),
        ("single points, left out", "single_points", stats.single_points),
        ("short lines, left out", "short", stats.short),
        ("cuts", "cuts", stats.cuts),
        ("points of open lines, at most", "open_points", stats.open_points),
        ("open ends of lines, at most", "open_ends", stats.open_ends),
        ("output (bytes)", "output_bytes", output_bytes),
        ("peak memory (bytes)", "peak_memory_bytes", peak_memory()),
    ]
}

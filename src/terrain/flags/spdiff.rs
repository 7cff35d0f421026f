//! `spdiff`: flags, and the counts of `--stats`.

mod report;

use std::path::{Path, PathBuf};
use std::slice;
use std::time::Instant;

use clap::{ArgGroup, Parser};

use crate::diff::{Comparison, Options, Other, Surface, compare};
use report::{Measured, Outputs};
use spmesh_base::error::{Error, Result};
use spmesh_formats::crs::System;
use spmesh_formats::source::{Polygon, read_polygons};
use spmesh_shell::progress::Progress;
use spmesh_shell::resources::{TempDirFlag, ThreadsFlag};
use spmesh_shell::stats::Row;
use spmesh_shell::{
    Common, Mesh, Needs, Report, StatsFlag, advise_on_memory, notice, parse_size, peak_memory,
    refuse_terminal,
};
use spmesh_stream::{Coordinates, Crs};

const TOOL: &str = "spdiff";

/// Most levels of a table.
const LEVELS_MAX: f64 = 1e6;

/// A part of the first mesh that is outside of the second one without a notice.
const OUTSIDE_MIN: f64 = 1e-5;

const EXAMPLES: &str = "\
Examples:
  What was dug out and filled up between two surveys:
    spdiff before.spm after.spm
  The same for each polygon of a file, with the accuracy of both surveys, as a table and as JSON:
    spdiff before.spm after.spm --by parcels.geojson --sd-a 0.05 --sd-b 0.03 -o volumes.tsv --report volumes.json
  The new survey from a pipe:
    spfinalize new.laz --keep-class 2 | spdelaunay2d | spdiff before.spm -
  How much water a basin holds below each level:
    spdiff basin.spm --levels 120:135:0.5 -o storage.tsv
  A stockpile on a sloping floor, at 12 m and rising by 2 cm for each metre to the east:
    spdiff pile.spm --plane 12,0.02,0
";

// Paragraphs are single lines: they are wrapped to the width of the terminal.
const NOTES: &str = "
Volumes lead from the first surface to the second: fill where the second is higher, cut where it is lower, net is fill \
minus cut. They are those of the prisms between the triangles of both meshes, over the places that both cover. A level or a \
plane is the second surface, so the fill below a level is the volume of water there.

Which triangles overlap where is decided exactly. Each piece is computed to about 100 binary digits, rounded to 2^-64 of a \
step of the grid, and added up without rounding. So net volumes of both orders differ in sign alone, and volumes of boxes \
that are put together add up to the last digit: --report has them as integers. Meshes whose coordinates are no integers \
on grids in line with each other are rounded to a fine grid first; a notice says so.

Areas have the unit of x and y squared, volumes this unit cubed; z is converted if its unit is known to be another one. \
Levels and standard deviations are in units of z. The column sd is the standard deviation of the net volume if the errors of a \
survey are the same everywhere, which no other correlation exceeds: the area times the root of the sum of squares.

Triangles wait in temporary files (13 bytes each, 19 if coordinates are no integers). Memory does not grow with the meshes but for 64 bytes for \
each two thousand triangles, for any order of triangles; orders without locality take time.

Exit codes: 0 success, 1 I/O or runtime failure, 2 usage, 3 malformed or truncated input, 5 not enough \
memory, 6 input of another version of spmesh, 141 output closed by its reader.";

/// Write cut and fill volumes between two triangle meshes, or between a mesh and levels or a plane.
///
/// Reads triangle meshes as spdelaunay2d writes them. Writes a table.
#[derive(Debug, Parser)]
#[command(name = TOOL, version, after_long_help = format!("{EXAMPLES}{NOTES}"))]
#[command(group = ArgGroup::new("other").args(["second", "level", "levels", "plane"]).required(true))]
pub struct Flags {
    /// Stream of the first triangle mesh; - is stdin
    #[arg(value_name = "A")]
    first: PathBuf,

    /// Stream of the second triangle mesh; - is stdin
    #[arg(value_name = "B")]
    second: Option<PathBuf>,

    /// Compare with a level
    #[arg(long, value_name = "Z", allow_negative_numbers = true)]
    level: Option<f64>,

    /// Compare with levels from the first to the last one
    #[arg(long, value_name = "FIRST:LAST:STEP", allow_hyphen_values = true, value_parser = parse_levels)]
    levels: Option<Levels>,

    /// Compare with a plane: its elevation at x = y = 0, and what it gains for a unit of x and of y. It is
    /// taken at the vertices of the mesh
    #[arg(long, value_name = "Z,DX,DY", value_delimiter = ',', num_args = 1, allow_hyphen_values = true)]
    plane: Vec<f64>,

    /// A row for each polygon of a file, numbered from 1 on: GeoJSON, Shapefile, GeoPackage (FILE.gpkg:LAYER
    /// for one layer) or WKT
    #[arg(long, value_name = "FILE")]
    by: Option<PathBuf>,

    /// File for the table: .tsv, .jsonl or .parquet; - is stdout, as TSV
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,

    /// File for all figures as JSON, also as integers without rounding; - is stdout
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,

    /// Standard deviation of elevations of the first mesh
    #[arg(long, value_name = "SD", value_parser = parse_deviation)]
    sd_a: Option<f64>,

    /// Standard deviation of elevations of the second surface
    #[arg(long, value_name = "SD", value_parser = parse_deviation)]
    sd_b: Option<f64>,

    /// Memory for vertices that are not final, then for blocks of triangles and sums
    #[arg(long, value_name = "SIZE", value_parser = parse_size, default_value = "160M")]
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

/// Levels in increasing order.
#[derive(Debug, Clone)]
struct Levels(Vec<f64>);

/// Parses FIRST:LAST:STEP.
fn parse_levels(text: &str) -> std::result::Result<Levels, String> {
    let wrong = |what: &str| format!("{text:?}: {what}, expected FIRST:LAST:STEP");
    let numbers: Option<Vec<f64>> =
        text.split(':').map(|part| part.parse().ok().filter(|number: &f64| number.is_finite())).collect();
    let Some(&[first, last, step]) = numbers.as_deref() else { return Err(wrong("no three numbers")) };
    if step <= 0.0 || last < first {
        return Err(wrong("no increasing levels"));
    }
    // The last one counts in spite of roundings.
    let steps = ((last - first) / step + 1e-9).floor();
    if steps >= LEVELS_MAX {
        return Err(wrong("more than a million levels"));
    }
    Ok(Levels((0..=steps as u32).map(|number| first + f64::from(number) * step).collect()))
}

fn parse_deviation(text: &str) -> std::result::Result<f64, String> {
    let deviation = text.parse().ok().filter(|deviation: &f64| deviation.is_finite() && *deviation >= 0.0);
    deviation.ok_or_else(|| format!("{text:?} is no standard deviation, expected a number from 0 on"))
}

/// Runs the tool.
///
/// # Errors
/// Those of [`Surface::read`], [`compare`] and [`read_polygons`], and if an input or output cannot be opened.
pub fn run(flags: Flags) -> anyhow::Result<()> {
    advise_on_memory(TOOL, "give less --memory, or fewer --threads");
    let started = Instant::now();
    flags.check()?;
    let outputs = Outputs::create(&flags.output, flags.report.as_deref())?;
    let (first, mut bytes) = flags.surface(&flags.first)?;
    let second = flags.second.as_ref().map(|path| flags.surface(path)).transpose()?;
    bytes += second.as_ref().map_or(0, |(_, bytes)| *bytes);
    let second = second.map(|(surface, _)| surface);
    let crs = system([Some(&first), second.as_ref()])?;
    let polygons = flags.polygons(&crs)?;
    let levels = flags.level.map(|level| vec![level]).or_else(|| flags.levels.clone().map(|levels| levels.0));
    let other = match (&second, &levels, &flags.plane[..]) {
        (Some(second), _, _) => Other::Mesh(second),
        (_, Some(levels), _) => Other::Levels(levels),
        (_, _, &[z, dx, dy]) => Other::Plane([z, dx, dy]),
        _ => unreachable!("one of them is required"),
    };
    let options = Options { polygons: &polygons, memory: flags.memory, threads: flags.threads.get().get() };
    let mut progress = Progress::counting("blocks", &flags.common, "comparing", None);
    let found = compare(&first, &other, &options, &mut |done, _| progress.set(done))?;
    drop(progress);
    flags.notices(&first, &found, second.is_some());
    let measured = Measured {
        first: &first,
        second: second.as_ref(),
        found: &found,
        levels: levels.as_deref(),
        plane: &flags.plane,
        has_polygons: flags.by.is_some(),
        crs: &crs,
        deviation: flags.deviation(),
    };
    outputs.write(&measured)?;
    flags
        .stats
        .print(|| Report::of(started.elapsed()).counts(counts(&first, second.as_ref(), &found, bytes)));
    Ok(())
}

/// The system of surfaces, of which one may state none.
fn system(surfaces: [Option<&Surface>; 2]) -> Result<Crs> {
    let surfaces = surfaces.into_iter().flatten();
    let crs = surfaces.map(|surface| surface.ground().crs()).find(|crs| **crs != Crs::Unknown);
    let crs = crs.cloned().unwrap_or(Crs::Unknown);
    let horizontal = System::of(&crs).horizontal;
    if horizontal.is_some_and(|horizontal| horizontal.is_angular()) {
        let what = "x and y are degrees, of which areas and volumes are not made";
        return Err(Error::usage(format!("{what}: transform the points to a projected system first")));
    }
    Ok(crs)
}

impl Flags {
    fn notice(&self, text: &str) {
        notice(TOOL, &self.common, text);
    }

    fn check(&self) -> Result<()> {
        let inputs = [Some(&self.first), self.second.as_ref(), self.by.as_ref()].into_iter().flatten();
        if inputs.filter(|path| path.as_os_str() == "-").count() > 1 {
            return Err(Error::usage("stdin can be one input only: give the others as files"));
        }
        let is_finite = |number: &f64| number.is_finite();
        if !(self.plane.is_empty() || self.plane.len() == 3) || !self.plane.iter().all(is_finite) {
            return Err(Error::usage("--plane takes three numbers: Z,DX,DY"));
        }
        if !self.level.iter().all(is_finite) {
            return Err(Error::usage("--level takes a finite number"));
        }
        Ok(())
    }

    /// Reads a mesh; also returns the number of bytes that were read.
    fn surface(&self, path: &Path) -> Result<(Surface, u64)> {
        let needs = Needs { window: None, beyond: None };
        let mut reader = Mesh::open(path)?.read(&needs)?.reader;
        let mut progress = Progress::new(&self.common, "reading a mesh", reader.header().points);
        let temp_dir = self.temp_dir.get();
        let surface = Surface::read(&mut reader, temp_dir, self.memory, |vertices| progress.set(vertices))?;
        Ok((surface, reader.bytes_read()))
    }

    fn polygons(&self, crs: &Crs) -> Result<Vec<Polygon>> {
        let Some(path) = &self.by else { return Ok(Vec::new()) };
        if path.as_os_str() == "-" {
            refuse_terminal()?;
        }
        let (polygons, notices) = read_polygons(slice::from_ref(path), &Coordinates::F64, crs, self.memory)?;
        notices.iter().for_each(|text| self.notice(text));
        if polygons.is_empty() {
            return Err(Error::usage("there are no polygons").of_input(path.display().to_string()));
        }
        Ok(polygons)
    }

    /// The standard deviation of a difference.
    fn deviation(&self) -> Option<f64> {
        let [a, b] = [self.sd_a, self.sd_b];
        a.or(b).map(|_| a.unwrap_or(0.0).hypot(b.unwrap_or(0.0)))
    }

    fn notices(&self, first: &Surface, found: &Comparison, is_mesh: bool) {
        if let Some([plane, z]) = found.rounded {
            let steps =
                if plane == z { format!("{plane:e}") } else { format!("{plane:e}, those of z to {z:e}") };
            self.notice(&format!(
                "coordinates have no grid of integers in common: they were rounded to {steps}"
            ));
        }
        // With polygons, nobody asks for the rest.
        let [volumes] = &found.volumes[..] else { return };
        let area = crate::diff::number(&volumes[0].area()) * found.units[0];
        let outside = first.area() - area;
        if is_mesh && self.by.is_none() && outside > OUTSIDE_MIN * first.area() {
            let share = 100.0 * outside / first.area();
            self.notice(&format!(
                "{share:.3} % of the first mesh is outside of the second one, and left out"
            ));
        }
    }
}

fn counts(first: &Surface, second: Option<&Surface>, found: &Comparison, bytes: u64) -> [Row<u64>; 5] {
    [
        ("input (bytes)", "input_bytes", bytes),
        ("triangles of A", "triangles_a", first.ground().triangles()),
        ("triangles of B", "triangles_b", second.map_or(0, |surface| surface.ground().triangles())),
        ("pieces", "pieces", found.pieces),
        ("peak memory (bytes)", "peak_memory_bytes", peak_memory()),
    ]
}

//! `splinefit eval`: flags.

use std::io::Seek;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::{Threads, check_stdin, say};
use crate::cli::{Common, parse_numbers, progress::Progress};
use crate::error::{Error, Result};
use crate::output::Output;
use crate::raster::{Grid, RasterFormat, Window};
use crate::source::{Input, SourceOptions};
use crate::splinefit::{self, Attribute, Cells, Spline};

// Paragraphs are single lines: they are wrapped to the width of the terminal.
const NOTES: &str = "\
Sites outside of the domain get nan, and cells there no data (-9999): splines are not extrapolated. A cell has what is at its \
centre.

Slopes are angles in degrees, aspects directions of steepest descent in degrees clockwise from north. Curvatures are those of \
normal sections, along the steepest descent (profile) and across it (tangential), in one over the unit of coordinates; they are \
positive where the surface is convex upwards. Where it is level, there is neither an aspect nor a curvature. Elevations and \
coordinates are taken to be in the same unit. Splines of degree 2 have second derivatives that jump.";

#[derive(Debug, Clone, Args)]
#[command(after_help = NOTES)]
pub(super) struct Flags {
    /// The spline; - is stdin
    #[arg(value_name = "SPLINE")]
    spline: PathBuf,

    /// Where values go; - is stdout. The ending tells the format: .tif or .asc, or else text
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,

    /// Sites: the output has a line for each, in their order; - is stdin
    #[arg(long, value_name = "SITES", conflicts_with_all = ["step", "columns", "rows", "bounds", "format"])]
    at: Option<PathBuf>,

    /// Sides of cells, which are at multiples of it [default: a thousand cells along the longer side]
    #[arg(long, value_name = "S", allow_negative_numbers = true, conflicts_with_all = ["columns", "rows"])]
    step: Option<f64>,

    /// Number of columns
    #[arg(long, value_name = "N", conflicts_with = "rows", value_parser = clap::value_parser!(u32).range(1..))]
    columns: Option<u32>,

    /// Number of rows
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    rows: Option<u32>,

    /// What the raster covers [default: the domain]
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_numbers::<4>, allow_hyphen_values = true)]
    bounds: Option<[f64; 4]>,

    /// What is evaluated
    #[arg(long, value_enum, value_name = "KIND", default_value_t = KindFlag::Value)]
    kind: KindFlag,

    /// GeoTIFF, ESRI ASCII grid, or lines of x, y and values
    #[arg(long, value_enum, value_name = "FORMAT")]
    format: Option<FormatFlag>,

    #[command(flatten)]
    threads: Threads,
}

/// What `--kind` can say.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum KindFlag {
    Value,
    Slope,
    Aspect,
    ProfileCurvature,
    TangentialCurvature,
    Gradient,
}

/// What `--format` can say.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum FormatFlag {
    Tif,
    Asc,
    Text,
}

impl Flags {
    pub(super) fn run(&self, common: &Common) -> Result<()> {
        let sites = self.at.as_ref().map(|path| ("--at", path.as_path()));
        check_stdin([("the spline", self.spline.as_path())].into_iter().chain(sites))?;
        match &self.at {
            Some(sites) => self.sites(common, sites),
            None => self.cells(common),
        }
    }

    fn sites(&self, common: &Common, sites: &Path) -> Result<()> {
        let mut output = Output::create(&self.output, false)?;
        let spline = Spline::open(&self.spline)?;
        let options = SourceOptions { dims: 2, ..SourceOptions::default() };
        let sites = Input::open(&[sites.to_path_buf()], &options)?;
        let mut progress = Progress::new(common, "evaluating", sites.description().stated_points);
        let counts = splinefit::write_values(&spline, self.kind.into(), &sites, &mut output, |count| {
            progress.set(count);
        });
        let [count, outside] = counts?;
        output.commit()?;
        drop(progress);
        if outside > 0 {
            say(common, &format!("{outside} of {count} sites are outside of the domain"));
        }
        Ok(())
    }

    fn cells(&self, common: &Common) -> Result<()> {
        let (format, attribute) = (self.format(), self.kind.into());
        let mut output = self.output(format, attribute)?;
        let spline = Spline::open(&self.spline)?;
        let grid = self.grid(&spline)?;
        let mut progress = Progress::counting("rows", common, "evaluating", Some(grid.rows.into()));
        let done = |row| progress.set(row);
        let threads = self.threads.get();
        let outside = match format {
            FormatFlag::Text => splinefit::write_table(&spline, attribute, &grid, &mut output, done),
            FormatFlag::Tif | FormatFlag::Asc => {
                let format =
                    if format == FormatFlag::Tif { RasterFormat::GeoTiff } else { RasterFormat::Ascii };
                splinefit::write_raster(&spline, attribute, &grid, format, threads, &mut output, done)
            }
        }?;
        output.commit()?;
        drop(progress);
        let Grid { columns, rows, step, .. } = grid;
        let all = grid.cells();
        let without = if outside > 0 { format!(", {outside} of {all} without data") } else { String::new() };
        say(common, &format!("{columns} by {rows} cells of size {step}{without}"));
        Ok(())
    }

    fn format(&self) -> FormatFlag {
        let ending = self.output.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        self.format.unwrap_or(match ending.as_deref() {
            Some("tif" | "tiff") => FormatFlag::Tif,
            Some("asc") => FormatFlag::Asc,
            _ => FormatFlag::Text,
        })
    }

    /// The output: what cannot be written is better known before the work.
    fn output(&self, format: FormatFlag, attribute: Attribute) -> Result<Output> {
        if format != FormatFlag::Text && !attribute.is_single() {
            return Err(Error::usage("a gradient is two numbers, and a cell has one: take --format text"));
        }
        let mut output = Output::create(&self.output, format == FormatFlag::Tif)?;
        if format == FormatFlag::Tif && output.stream_position().is_err() {
            let what = "GeoTIFF is not written in order, and a pipe takes nothing else: use -o FILE, or --format asc";
            return Err(Error::usage(what));
        }
        Ok(output)
    }

    fn grid(&self, spline: &Spline) -> Result<Grid> {
        let cells = match (self.step, self.columns, self.rows) {
            (Some(step), ..) => Cells::Step(step),
            (_, Some(columns), _) => Cells::Columns(columns),
            (_, _, Some(rows)) => Cells::Rows(rows),
            _ => Cells::Default,
        };
        let window = match self.bounds {
            Some([x0, y0, x1, y1]) if x0 < x1 && y0 < y1 => Some(Window { min: [x0, y0], max: [x1, y1] }),
            Some([x0, y0, x1, y1]) => {
                return Err(Error::usage(format!(
                    "bounds {x0},{y0},{x1},{y1} are empty: expected least x, least y, greatest x, greatest y"
                )));
            }
            None => None,
        };
        spline.grid(cells, window)
    }
}

impl From<KindFlag> for Attribute {
    fn from(kind: KindFlag) -> Attribute {
        match kind {
            KindFlag::Value => Attribute::Value,
            KindFlag::Slope => Attribute::Slope,
            KindFlag::Aspect => Attribute::Aspect,
            KindFlag::ProfileCurvature => Attribute::ProfileCurvature,
            KindFlag::TangentialCurvature => Attribute::TangentialCurvature,
            KindFlag::Gradient => Attribute::Gradient,
        }
    }
}

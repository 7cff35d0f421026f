//! `splinefit eval`: flags.

use std::iter;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::{Threads, check_stdin, say};
use crate::cells::{self, CellFlags, RasterFlags};
use crate::endings;
use crate::{Common, progress::Progress};
use spmesh_core::error::{Error, Result};
use spmesh_core::output::Output;
use spmesh_core::places::check_apart;
use spmesh_io::detect::SPLINEFIT;
use spmesh_io::raster::RasterFormat;
use spmesh_io::source::{Input, SourceOptions};
use spmesh_splinefit::{Attribute, Spline};

// Paragraphs are single lines: they are wrapped to the width of the terminal.
const NOTES: &str = "\
Splines are not extrapolated: outside of the domain, sites get nan and cells no data (-9999). A cell has the value at its centre.

Slopes are angles in degrees. Aspects are directions of steepest descent, in degrees clockwise from north. \
Curvatures are those of normal sections along the steepest descent (profile) and across it (tangential), in \
one over the unit of coordinates; they are positive where the surface is convex upwards. Level places have \
neither aspect nor curvature. Elevations and coordinates are taken to be in the same unit. Second \
derivatives of splines of degree 2 jump.";

#[derive(Debug, Clone, Args)]
#[command(after_help = NOTES)]
pub(super) struct Flags {
    /// The spline; - is stdin
    #[arg(value_name = "SPLINE")]
    spline: PathBuf,

    /// Output file; - is stdout. The extension selects the format: .tif or .asc, otherwise text
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,

    /// Sites: the output has a line for each, in their order; - is stdin
    #[arg(long, value_name = "SITES", conflicts_with_all = ["step", "columns", "rows", "bounds", "like", "format"])]
    at: Option<PathBuf>,

    #[command(flatten)]
    cells: CellFlags,

    #[command(flatten)]
    raster: RasterFlags,

    /// The attribute to evaluate
    #[arg(long, value_enum, value_name = "KIND", default_value_t = KindFlag::Value)]
    kind: KindFlag,

    /// GeoTIFF, ESRI ASCII grid, or lines of x, y and values
    #[arg(long, value_enum, value_name = "FORMAT")]
    format: Option<FormatFlag>,

    #[command(flatten)]
    threads: Threads,
}

/// Values of `--kind`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum KindFlag {
    Value,
    Slope,
    Aspect,
    ProfileCurvature,
    TangentialCurvature,
    Gradient,
}

/// Values of `--format`.
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
        let inputs = iter::once(&self.spline).chain(&self.at).chain(self.cells.like());
        check_apart(inputs.map(PathBuf::as_path), &[("--output", &self.output)])?;
        if self.format.is_none() {
            let of_cells = if self.at.is_none() { endings::RASTER } else { &[] };
            endings::check(&self.output, &[of_cells, endings::TABLE])?;
        }
        match &self.at {
            Some(sites) => self.sites(common, sites),
            None => self.cells(common),
        }
    }

    fn sites(&self, common: &Common, sites: &Path) -> Result<()> {
        self.raster.check_unused()?;
        let mut output = Output::create(&self.output, false)?;
        let spline = Spline::open(&self.spline)?;
        let options = SourceOptions { reader: &SPLINEFIT, dims: 2, ..SourceOptions::default() };
        let sites = Input::open(&[sites.to_path_buf()], &options)?;
        let mut progress = Progress::new(common, "evaluating", sites.description().stated_points);
        let counts =
            spmesh_splinefit::write_values(&spline, self.kind.into(), &sites, &mut output, |count| {
                progress.set(count);
            });
        let [count, outside] = counts?;
        output.commit()?;
        drop(progress);
        sites.withheld_notice().iter().for_each(|text| say(common, text));
        if outside > 0 {
            say(common, &format!("{outside} of {count} sites are outside of the domain"));
        }
        Ok(())
    }

    fn cells(&self, common: &Common) -> Result<()> {
        let (format, attribute) = (self.format(), self.kind.into());
        let mut output = self.output(format, attribute)?;
        let spline = Spline::open(&self.spline)?;
        let grid = self.cells.grid(|| spline.window())?;
        let mut progress = Progress::counting("rows", common, "evaluating", Some(grid.rows.into()));
        let done = |row| progress.set(row);
        let threads = self.threads.get();
        let (outside, notices) = match format {
            None => spmesh_splinefit::write_table(&spline, attribute, &grid, &mut output, done)
                .map(|outside| (outside, Vec::new())),
            Some(format) => {
                let options = self.raster.options(format)?;
                spmesh_splinefit::write_raster(
                    &spline,
                    attribute,
                    &grid,
                    &options,
                    threads,
                    &mut output,
                    done,
                )
            }
        }?;
        output.commit()?;
        drop(progress);
        notices.iter().for_each(|text| say(common, text));
        say(common, &cells::summary(&grid, outside));
        Ok(())
    }

    /// The format of a raster; `None` for lines.
    fn format(&self) -> Option<RasterFormat> {
        match self.format {
            Some(FormatFlag::Tif) => Some(RasterFormat::GeoTiff),
            Some(FormatFlag::Asc) => Some(RasterFormat::Ascii),
            Some(FormatFlag::Text) => None,
            None => cells::format_of(&self.output),
        }
    }

    fn output(&self, format: Option<RasterFormat>, attribute: Attribute) -> Result<Output> {
        match format {
            Some(_) if !attribute.is_single() => {
                Err(Error::usage("a gradient is two numbers, and a cell has one: take --format text"))
            }
            Some(format) => cells::create(&self.output, format),
            None => {
                self.raster.check_unused()?;
                Output::create(&self.output, false)
            }
        }
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

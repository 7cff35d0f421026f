//! `splinefit eval`: flags.

use std::path::{Path, PathBuf};

use clap::Args;

use super::eval_format::{FORMATS, Form, KINDS, format_of};
use super::fit::{parse_positive, read_weights};
use super::{check_stdin, say};
use crate::splinefit::{Attribute, Certainty, Layout, Points, Spline};
use spmesh_base::error::{Error, Result};
use spmesh_base::output::Output;
use spmesh_formats::detect::SPLINEFIT;
use spmesh_formats::raster::{Grid, RasterFormat, write_prj};
use spmesh_formats::sink::MatrixFormat;
use spmesh_formats::source::{Input, InvalidAdvice, SourceOptions};
use spmesh_shell::cells::{self, CellFlags, RasterFlags};
use spmesh_shell::resources::ThreadsFlag;
use spmesh_shell::{Common, named, progress::Progress};

// Paragraphs are single lines: they are wrapped to the width of the terminal.
const NOTES: &str = "\
Outside of the domain of the knots, sites and arrays get nan, cells of rasters no data, and cells as text are \
left out. Inside of it there are values also far from all points: these are extrapolated. A cell has the value at \
its centre.

Slopes are angles in degrees. Aspects are directions of steepest descent, in degrees clockwise from north. \
Curvatures are those of normal sections along the steepest descent (profile) and across it (tangential), \
in one over the unit of coordinates; they are positive where the surface is convex upwards. Level places \
have neither aspect nor curvature. Elevations and coordinates are taken to be in the same unit. Second \
derivatives of splines of degree 2 jump at knot lines.

Tables start with a line of # and the names of columns, which numpy.loadtxt and \
numpy.genfromtxt(names=True) read. Arrays (.npy) have the numbers alone: shape (sites,) or, for gradients \
and Hessians, (sites, numbers); of cells (rows, columns) or (rows, columns, numbers), with the top row \
first.

Functions of the basis are numbered from 0. The collocation matrix, or design matrix, has a row for each \
site and a column for each function: multiplied by the coefficients, it gives the values. Rows of sites \
outside of the domain are empty. Its entries wait in temporary files, because both formats state their number first.";

const EXAMPLES: &str = "\
Examples:
  Values at sites from numpy, to numpy:
    splinefit eval terrain.spline.spm --at sites.npy -o values.npy
  Second derivatives at sites, as a table:
    splinefit eval terrain.spline.spm --at sites.txt --kind hessian -o hessians.txt
  A raster as an array:
    splinefit eval terrain.spline.spm --step 0.5 -o terrain.npy
  Basis function 17, as a raster:
    splinefit eval terrain.spline.spm --basis-function 17 --columns 500 -o function.tif
  The collocation matrix, for scipy.sparse.load_npz or scipy.io.mmread:
    splinefit eval terrain.spline.spm --at sites.npy --collocation -o matrix.npz
    splinefit eval terrain.spline.spm --at sites.npy --collocation -o matrix.mtx
";

#[derive(Debug, Clone, Args)]
#[command(after_help = format!("{EXAMPLES}\n{NOTES}"))]
pub(super) struct Flags {
    /// The spline; - is stdin. With --collocation and --basis-function also configurations
    #[arg(value_name = "SPLINE")]
    spline: PathBuf,

    /// Output file; - is stdout. The extension selects the format: .tif, .asc or .npy, for --collocation .mtx
    /// or .npz, otherwise text
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,

    /// Sites, such as text or .npy of shape (n, 2): the output has a line or row for each, in their order; -
    /// is stdin
    #[arg(long, value_name = "SITES", conflicts_with_all = ["step", "columns", "rows", "bounds", "like"])]
    at: Option<PathBuf>,

    /// The attribute to evaluate
    #[arg(long, value_name = "KIND", default_value = "value", value_parser = named(KINDS))]
    kind: Attribute,

    /// The points that the spline was fitted to, for the kinds of errors
    #[arg(long, value_name = "POINTS", num_args = 1.., conflicts_with_all = ["basis_function", "collocation"])]
    points: Vec<PathBuf>,

    /// Leave out places that are farther from the nearest of the points of --points
    #[arg(long, value_name = "D", requires = "points", value_parser = parse_positive, conflicts_with = "collocation")]
    max_distance: Option<f64>,

    /// Outside of the domain, continue linearly from the nearest place of its border
    #[arg(long, value_name = "linear", value_parser = named(&[("linear", ())]), conflicts_with = "collocation")]
    extrapolate: Option<()>,

    /// The weights of these points in the fit
    #[arg(long, value_name = "FILE", requires = "points")]
    weights: Option<PathBuf>,

    /// Evaluate this function of the basis instead of the spline; functions are numbered from 0
    #[arg(long, value_name = "J")]
    basis_function: Option<u32>,

    /// Write the collocation matrix instead of values: the values of all functions of the basis at the sites
    #[arg(long, requires = "at", conflicts_with_all = ["kind", "basis_function"])]
    collocation: bool,

    /// GeoTIFF, ESRI ASCII grid, an array of numpy, or lines of x, y and values; for --collocation
    /// MatrixMarket or the arrays of scipy
    #[arg(long, value_name = "FORMAT", value_parser = named(FORMATS))]
    format: Option<Form>,

    #[command(flatten)]
    threads: ThreadsFlag,

    #[command(flatten)]
    cells: CellFlags,

    #[command(flatten)]
    raster: RasterFlags,
}

impl Flags {
    pub(super) fn run(&self, common: &Common) -> Result<()> {
        self.check_points()?;
        let sites = self.at.as_ref().map(|path| ("--at", path.as_path()));
        let points = self.points.iter().map(|path| ("--points", path.as_path()));
        check_stdin([("the spline", self.spline.as_path())].into_iter().chain(sites).chain(points))?;
        let form = format_of(&self.output, self.format, self.at.is_some(), self.collocation)?;
        match (&self.at, form) {
            (Some(sites), Form::Matrix(format)) => self.matrix(common, sites, format),
            (Some(sites), form) => self.sites(common, sites, form == Form::Array),
            (None, form) => self.cells(common, form),
        }
    }

    fn check_points(&self) -> Result<()> {
        match (self.kind.is_error(), self.points.is_empty() || self.max_distance.is_some()) {
            _ if self.kind.is_error() && self.points.is_empty() => Err(Error::usage(
                "errors follow from the points that the spline was fitted to: give them with --points",
            )),
            (false, false) => Err(Error::usage(
                "--points is for the kinds of errors and --kind interval: leave it out, or give --max-distance",
            )),
            _ => Ok(()),
        }
    }

    fn spline(&self, common: &Common) -> Result<Spline> {
        let spline = match self.basis_function {
            Some(function) => return Spline::open_function(&self.spline, function),
            None => Spline::open(&self.spline)?,
        };
        let spline = if self.extrapolate.is_some() { spline.extrapolated() } else { spline };
        if self.points.is_empty() {
            return Ok(spline);
        }
        let weights = self.weights.as_ref().map(|path| read_weights(path)).transpose()?;
        let options = SourceOptions { reader: &SPLINEFIT, holds_points: true, ..SourceOptions::default() };
        let points = Points::open(&self.points, &options, weights, Vec::new(), true, |_| ())?;
        points.notices().iter().for_each(|text| say(common, text));
        let spline = match self.max_distance {
            Some(distance) => spline.near(&points, distance)?,
            None => spline,
        };
        if !self.kind.is_error() {
            return Ok(spline);
        }
        let (certainty, smoothing) = Certainty::of(&spline, &points, self.threads.get())?;
        let Certainty { noise, width, .. } = certainty;
        say(
            common,
            &format!(
                "noise {noise:.4e}, lambda {:.4e}, intervals of {width:.3} prediction errors",
                smoothing.lambda
            ),
        );
        Ok(Spline { certainty: Some(certainty), ..spline })
    }

    fn sites(&self, common: &Common, sites: &Path, is_array: bool) -> Result<()> {
        self.raster.check_unused()?;
        let mut output = Output::create(&self.output, is_array)?;
        let spline = self.spline(common)?;
        let sites = open_sites(sites)?;
        let mut progress = Progress::new(common, "evaluating", sites.description().stated_points);
        let (attribute, done) = (self.kind, |count| progress.set(count));
        let (temp_dir, into) = (self.raster.temp_dir(), &mut output);
        let [count, outside] = match is_array {
            true => crate::splinefit::write_value_array(&spline, attribute, &sites, temp_dir, into, done)?,
            false => crate::splinefit::write_values(&spline, attribute, &sites, into, done)?,
        };
        output.commit()?;
        drop(progress);
        sites.withheld_notice().iter().for_each(|text| say(common, text));
        about_outside(common, [count, outside], "");
        Ok(())
    }

    fn matrix(&self, common: &Common, sites: &Path, format: MatrixFormat) -> Result<()> {
        self.raster.check_unused()?;
        let mut output = Output::create(&self.output, format == MatrixFormat::Npz)?;
        let (layout, _) = Layout::open(&self.spline)?;
        let sites = open_sites(sites)?;
        let mut progress = Progress::new(common, "evaluating", sites.description().stated_points);
        let done = |count| progress.set(count);
        let (temp_dir, into) = (self.raster.temp_dir(), &mut output);
        let counts = crate::splinefit::write_collocation(&layout, &sites, format, temp_dir, into, done)?;
        output.commit()?;
        drop(progress);
        sites.withheld_notice().iter().for_each(|text| say(common, text));
        say(common, &format!("{} by {} matrix, {} entries", counts.sites, counts.functions, counts.entries));
        about_outside(common, [counts.sites, counts.outside], ": their rows are empty");
        Ok(())
    }

    fn cells(&self, common: &Common, form: Form) -> Result<()> {
        let attribute = self.kind;
        let mut output = self.output(form, attribute)?;
        let spline = self.spline(common)?;
        let grid = self.cells.grid(spline.crs(), || spline.window())?;
        let mut progress = Progress::counting("rows", common, "evaluating", Some(grid.rows.into()));
        let done = |row| progress.set(row);
        let threads = self.threads.get();
        let (outside, notices) = match form {
            Form::Raster(format) => {
                let options = self.raster.options(format)?;
                let output = &mut output;
                crate::splinefit::write_raster(&spline, attribute, &grid, &options, threads, output, done)?
            }
            Form::Array => {
                let output = &mut output;
                let outside =
                    crate::splinefit::write_cell_array(&spline, attribute, &grid, threads, output, done)?;
                (outside, vec![place_of_cells(&grid)])
            }
            Form::Text | Form::Matrix(_) => {
                let outside = crate::splinefit::write_table(&spline, attribute, &grid, &mut output, done)?;
                (outside, Vec::new())
            }
        };
        let lost = match form {
            Form::Raster(RasterFormat::Ascii) => write_prj(&self.output, spline.crs())?,
            _ => None,
        };
        output.commit()?;
        drop(progress);
        notices.iter().chain(&lost).for_each(|text| say(common, text));
        say(common, &cells::summary(&grid, outside));
        Ok(())
    }

    fn output(&self, form: Form, attribute: Attribute) -> Result<Output> {
        match form {
            Form::Raster(_) if !attribute.is_single() => Err(Error::usage(format!(
                "{} numbers at each place, but a cell of a raster has one: take .npy or --format text",
                attribute.columns().len()
            ))),
            Form::Raster(format) => cells::create(&self.output, format),
            _ => {
                self.raster.check_unused()?;
                Output::create(&self.output, form == Form::Array)
            }
        }
    }
}

/// Says how many sites are outside of the domain.
fn about_outside(common: &Common, [count, outside]: [u64; 2], consequence: &str) {
    if outside > 0 {
        say(common, &format!("{outside} of {count} sites are outside of the domain{consequence}"));
    }
}

fn open_sites(path: &Path) -> Result<Input> {
    let options = SourceOptions {
        reader: &SPLINEFIT,
        dims: 2,
        invalid_advice: InvalidAdvice::LeaveOut,
        ..SourceOptions::default()
    };
    Input::open(&[path.to_path_buf()], &options)
}

/// Where the cells of an array are, which holds no coordinates.
fn place_of_cells(grid: &Grid) -> String {
    let ([x, y], step) = (grid.center(0, 0), grid.step);
    format!("array[i, j] is at x = {x} + {step} * j, y = {y} - {step} * i")
}

//! `splinefit fit`: flags.

use std::cell::RefCell;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;

use super::{check_stdin, report, say};
use crate::fitting::Loss;
use crate::splinefit::{Anisotropy, Options, Points, Smoothing, Validation};
use spmesh_base::error::{Error, Result};
use spmesh_base::output::Output;
use spmesh_formats::detect::SPLINEFIT;
use spmesh_formats::source::{
    Filters, InvalidAdvice, LineSystem, Opened, Polyline, SourceOptions, TextOptions, Values, name_of,
    open_knots, read_polylines, read_values,
};
use spmesh_shell::compression::Compression;
use spmesh_shell::crs::CrsFlag;
use spmesh_shell::endings;
use spmesh_shell::resources::ThreadsFlag;
use spmesh_shell::text_flags::TextFlags;
use spmesh_shell::{Common, StatsFlag, named, open_held, parse_box, progress::Progress, refuse_terminal};
use spmesh_stream::model::bounds::Bounds;

// Paragraphs are single lines: they are wrapped to the width of the terminal.
const NOTES: &str = "\
Without flags of knots, knots follow the density of points, over their convex hull. They become denser, level by \
level, until a finer level predicts no better and residuals of neighbours are unlike each other: what is left \
is noise. If no level is enough, there are about four knots for each point (at most 600,000), and the smoothing \
is chosen over a quarter of them. Points of one place count as one, with their mean and weight.

With --tol or --max-knots, a search starts with a coarse grid over the box of the points. Each round adds knots \
where residuals exceed --tol [default: 0.25 % of the range of most elevations], up to --max-knots [default: one \
for 4 points, at most 20,000]. With --step, knots form a grid with cells of this side. Points as \
knots are for splines of degree 2 over their convex hull: the border is pulled apart.

Without --lambda, given knots get the coefficients of least squares. Coefficients that the points leave \
undetermined are those of least energy. For other knots, lambda and the tension are chosen by restricted \
maximum likelihood (reml), which bridges gaps and adapts to noise and to steps of the ground. No choice of \
lambda is less than a floor that depends on the distance of points. LAMBDA multiplies an energy, which is \
added to the sum of squares of residuals. It is that of a thin plate (plus a thousandth of the bending of the \
control mesh) and, with a tension T, T squared over the area of a point times that of a membrane.

--features has sharp corners, creases (sharp up to their ends, or smooth there) and polylines along which \
values are linear. Their vertices become knots. Long segments get more knots, and other knots near them are \
dropped. In GeoJSON points are corners, and lines and rings are creases, unless a feature has a property \
spline with one of the words. Polylines may meet at common vertices only.

--robust weighs points by their residuals, iteratively: huber reduces weights beyond 1.345 standard \
deviations, tukey reduces them to zero at 4.685, where points are rejected. The deviation is estimated from \
the median of magnitudes; for rejecting points it is greater where many residuals nearby are. If lambda is chosen, it is chosen with these weights.";

#[derive(Debug, Clone, Args)]
#[command(after_help = NOTES)]
#[command(mut_arg("stats", |stats| stats.help("Print what the run did on stderr")))]
pub(super) struct Flags {
    /// Files of points, read as one input (text, csv, LAS, LAZ, COPC, SPA, SPB, NPY, vertices of PLY, OBJ and
    /// VTK, point streams); - is stdin
    #[arg(value_name = "POINTS", default_value = "-")]
    inputs: Vec<PathBuf>,

    /// Where the spline goes; - is stdout
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,

    /// Knots: points, a stream of configurations, or a spline whose knots are reused; - is stdin
    #[arg(long, value_name = "FILE", conflicts_with_all = ["tol", "max_knots", "step"])]
    knots: Option<PathBuf>,

    /// Degree of splines, where --knots has configurations of several degrees [default: 2 if functions are
    /// listed, or else one more than the highest]
    #[arg(long, value_name = "K")]
    degree: Option<usize>,

    /// Tolerance of the search: add knots where residuals exceed T, in units of elevations
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = parse_positive)]
    tol: Option<f64>,

    /// Maximum number of distinct knots of the search; features may add as many again
    #[arg(long, value_name = "N")]
    max_knots: Option<usize>,

    /// Place knots on a grid of cells with this side instead of searching; inner knots are moved slightly
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = parse_positive)]
    #[arg(conflicts_with_all = ["tol", "max_knots"])]
    step: Option<f64>,

    /// Values vary RATIO times more slowly along ANGLE (degrees counterclockwise from x) than across; auto
    /// finds both, rescale makes the box of the points square [default: 1, or rescale if the sides of the box
    /// differ more than 100-fold, or more than 3-fold and this predicts better]
    #[arg(long, value_name = "RATIO[:ANGLE]|auto|rescale", allow_negative_numbers = true)]
    #[arg(conflicts_with_all = ["knots", "features"])]
    anisotropy: Option<Anisotropy>,

    /// How far the domain reaches beyond the convex hull of the points [default: half their typical distance]
    #[arg(long, value_name = "D", allow_negative_numbers = true, value_parser = parse_tension)]
    #[arg(conflicts_with_all = ["knots", "step", "tol", "max_knots"])]
    widen: Option<f64>,

    /// How much to smooth: a number, reml (restricted maximum likelihood), gcv (generalised
    /// cross-validation), or cv or cv:FOLDS (cross-validation)
    #[arg(long, value_name = "LAMBDA|reml|gcv|cv[:FOLDS]", allow_negative_numbers = true)]
    lambda: Option<Smoothing>,

    /// Tension: 0 for a thin plate; with more, waves longer than six distances of points over T are those of
    /// a membrane, which follows points more closely [default: chosen with reml, or else 0]
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = parse_tension)]
    #[arg(conflicts_with_all = ["robust", "interpolate"])]
    tension: Option<f64>,

    /// Weigh points by their residuals, so that gross errors count little, or not at all
    #[arg(long, value_name = "huber|tukey", hide_possible_values = true)]
    #[arg(value_parser = named(&[("huber", Loss::Huber), ("tukey", Loss::Tukey)]))]
    robust: Option<Loss>,

    /// Instead of least squares, interpolate: pass through the triangulated points at the Greville sites
    #[arg(long, requires = "knots")]
    interpolate: bool,

    /// Weights of points: a number on each line, in the order of the points; - is stdin
    #[arg(long, value_name = "FILE")]
    weights: Option<PathBuf>,

    /// Corners and breaklines in the coordinates of the points: lines of corner, crease, smooth-crease or
    /// linear and X Y X Y ..., GeoJSON, Shapefile or GeoPackage (FILE.gpkg:LAYER for one layer); - is stdin
    #[arg(long, value_name = "FILE")]
    features: Option<PathBuf>,

    /// List the points in the domain: lines of x, y, z and elevation less spline
    #[arg(long, value_name = "FILE")]
    residuals: Option<PathBuf>,

    /// List the points that --robust rejects, in the same way
    #[arg(long, value_name = "FILE", requires = "robust")]
    rejected: Option<PathBuf>,

    #[command(flatten)]
    crs: CrsFlag,

    /// Keep only points of these classes
    #[arg(long, value_name = "CLASS", value_delimiter = ',')]
    keep_class: Vec<u8>,

    /// Drop points of these classes
    #[arg(long, value_name = "CLASS", value_delimiter = ',')]
    drop_class: Vec<u8>,

    /// Keep only points that lie in this closed box: MINX,MINY,MINZ,MAXX,MAXY,MAXZ or, whatever their z,
    /// MINX,MINY,MAXX,MAXY
    #[arg(long, value_name = "BOX", value_parser = parse_box, allow_hyphen_values = true)]
    bounds: Option<Bounds>,

    /// Drop and count points with a coordinate that is not finite, instead of failing
    #[arg(long)]
    skip_invalid: bool,

    /// Leave out points with this elevation, which stands for none; may be repeated
    #[arg(long, value_name = "Z", allow_negative_numbers = true, value_parser = parse_finite)]
    no_data: Vec<f64>,

    /// Also predict each point from others, and report errors and how many points intervals of 95 % hold:
    /// random FOLDS of places, ten folds of squares (side: an eighth of the box), or each place from all others
    /// with knots and smoothing of the fit
    #[arg(long, value_name = "FOLDS|blocks[:SIDE]|one", conflicts_with_all = ["robust", "interpolate", "knots"])]
    cross_validate: Option<Validation>,

    /// List these predictions: lines of x, y, z, prediction, its error, and the ends of the interval
    #[arg(long, value_name = "FILE", requires = "cross_validate")]
    predictions: Option<PathBuf>,

    /// Seed of folds
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,

    #[command(flatten)]
    text: TextFlags,

    #[command(flatten)]
    threads: ThreadsFlag,

    #[command(flatten)]
    compression: Compression,

    #[command(flatten)]
    stats: StatsFlag,
}

impl Flags {
    pub(super) fn run(&self, common: &Common) -> Result<()> {
        let started = Instant::now();
        self.check_stdin()?;
        endings::check(&self.output, &[endings::STREAM])?;
        let lists = [&self.residuals, &self.rejected, &self.predictions].into_iter().flatten();
        lists.into_iter().try_for_each(|path| endings::check(path, &[endings::NUMBERS]))?;
        // Fail before the work if an output cannot be created.
        let mut output = Output::create(&self.output, true)?;
        let residuals = self.residuals.as_ref().map(|path| Output::create(path, false)).transpose()?;
        let rejected = self.rejected.as_ref().map(|path| Output::create(path, false)).transpose()?;
        let predictions = self.predictions.as_ref().map(|path| Output::create(path, false)).transpose()?;
        let features = self.features.as_deref().map(read_features).transpose()?;
        let (polylines, system, layers) =
            features.map_or_else(Default::default, |(lines, system, layers)| (lines, Some(system), layers));
        layers.iter().for_each(|text| say(common, text));
        let options = self.options(polylines);
        let points = self.points(common)?;
        if let Some(system) = system {
            // Lines of text are in the system of the points: a notice would tell nothing.
            system.check(&options.polylines_name, points.crs())?;
        }
        points.notices().iter().for_each(|text| say(common, text));
        let knots = self.knots(common)?;
        let progress = RefCell::new(Progress::new(common, "fitting", None));
        let fitted =
            crate::splinefit::fit(&points, knots, &options, &|read| progress.borrow_mut().set(read))?;
        let validated = self.cross_validate.map(|validation| {
            let done = |read| progress.borrow_mut().set(read);
            crate::splinefit::validate(&fitted, &points, validation, &options, &done)
        });
        let validated = validated.transpose()?;
        drop(progress);
        fitted.spline.write(self.compression.of_stream(), &mut output)?;
        let output_bytes = output.bytes_written();
        list(residuals, |list| {
            crate::splinefit::write_residuals(&fitted.spline, &points, options.threads, list)
        })?;
        let rejected = list(rejected, |list| fitted.write_rejected(&points, &options, list))?;
        if let Some(validated) = &validated {
            list(predictions, |list| validated.write(list))?;
        }
        output.commit()?;
        report::notices(&fitted.report, &fitted.spline, rejected).iter().for_each(|text| say(common, text));
        validated.iter().for_each(|validated| say(common, &report::of_validation(validated)));
        let time = started.elapsed();
        self.stats
            .print(|| report::stats(&fitted, rejected, validated.as_ref(), self.seed, time, output_bytes));
        Ok(())
    }

    fn check_stdin(&self) -> Result<()> {
        let others = [("--knots", &self.knots), ("--features", &self.features), ("--weights", &self.weights)];
        let others = others.iter().filter_map(|(flag, path)| Some((*flag, path.as_deref()?)));
        check_stdin(self.inputs.iter().map(|path| ("points", path.as_path())).chain(others))
    }

    fn options(&self, polylines: Vec<Polyline>) -> Options {
        Options {
            smoothing: self.lambda,
            tension: self.tension,
            loss: self.robust,
            interpolates: self.interpolate,
            tolerance: self.tol,
            max_knots: self.max_knots,
            step: self.step,
            widen: self.widen,
            anisotropy: self.anisotropy,
            distance: None,
            polylines,
            polylines_name: self.features.as_deref().map(name_of).unwrap_or_default(),
            degree: self.degree,
            wants_errors: self.cross_validate.is_some(),
            seed: self.seed,
            threads: self.threads.get(),
        }
    }

    fn points(&self, common: &Common) -> Result<Points> {
        let source = SourceOptions {
            reader: &SPLINEFIT,
            filters: Filters {
                keep_class: self.keep_class.clone(),
                drop_class: self.drop_class.clone(),
                ..Filters::default()
            },
            bounds: self.bounds,
            skip_invalid: self.skip_invalid,
            invalid_advice: InvalidAdvice::SkipInvalid,
            threads: Some(self.threads.get()),
            crs: self.crs.system()?,
            holds_points: true,
            text: TextOptions { needs_z: true, ..self.text.options() },
            ..SourceOptions::default()
        };
        let weights = self.weights.as_ref().map(|path| read_weights(path)).transpose()?;
        // The search for knots and the robust weights need many passes.
        let is_search = self.knots.is_none() && self.step.is_none();
        let often = is_search || self.robust.is_some();
        let mut progress = Progress::new(common, "reading", None);
        Points::open(&self.inputs, &source, weights, self.no_data.clone(), often, |count| progress.set(count))
    }

    fn knots(&self, common: &Common) -> Result<Option<(Opened, String)>> {
        let Some(path) = &self.knots else { return Ok(None) };
        let options =
            SourceOptions { reader: &SPLINEFIT, dims: 2, holds_points: true, ..SourceOptions::default() };
        let source = open_knots(path, &options)?;
        if let Opened::Points(input) = &source {
            input.notices().iter().for_each(|text| say(common, text));
        }
        Ok(Some((source, name_of(path))))
    }
}

/// Writes a list, if its output is given.
fn list<T>(output: Option<Output>, write: impl FnOnce(&mut Output) -> Result<T>) -> Result<Option<T>> {
    let Some(mut output) = output else { return Ok(None) };
    let written = write(&mut output)?;
    output.flush().map_err(|error| Error::io("writing", error))?;
    output.commit()?;
    Ok(Some(written))
}

fn read_features(path: &Path) -> Result<(Vec<Polyline>, LineSystem, Option<String>)> {
    if path.as_os_str() == "-" {
        refuse_terminal()?;
    }
    read_polylines(path)
}

pub(super) fn read_weights(path: &Path) -> Result<Vec<f64>> {
    let (input, name) = open_held(path)?;
    match read_values(input).map_err(|error| error.of_input(&name))? {
        Values::Numbers(numbers) => Ok(numbers),
        Values::Vectors(_) => {
            Err(Error::malformed("found two numbers on a line, expected one weight").of_input(name))
        }
    }
}

fn parse_tension(text: &str) -> std::result::Result<f64, String> {
    let number = text.parse().ok().filter(|&number: &f64| number >= 0.0 && number.is_finite());
    number.ok_or_else(|| format!("{text:?} is not a finite number from zero on"))
}

fn parse_finite(text: &str) -> std::result::Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| format!("{text:?} is not a finite number"))
}

pub(super) fn parse_positive(text: &str) -> std::result::Result<f64, String> {
    let number = text.parse().ok().filter(|&number: &f64| number > 0.0 && number.is_finite());
    number.ok_or_else(|| format!("{text:?} is not a number above zero"))
}

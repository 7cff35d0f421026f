//! From points and knots to coefficients.

use std::io::Write;

use super::frame::Frame;
use super::layout::{Layout, Spline};
use super::options::{Options, Smoothing};
use super::points::{Points, PointsInFrame};
use super::smoothing_choice::{Problem, SmoothingChoice, choose_smoothing};
use super::statistics::Statistics;
use super::{breaklines, given_knots, statistics};
use crate::fitting::{
    self, Goal, Interpolation, KNOTS_MIN, Mesh, Observation, Observations, Residual, RobustFit, Round,
    Solution, Spacing, SplineSpace,
};
use spmesh_base::error::{Error, Result};
use spmesh_formats::source::Opened;

/// The default tolerance, as a part of the range of elevations.
const TOLERANCE_PART: f64 = 0.0025;
/// Residuals below this part of the greatest magnitude of elevations are rounding errors.
const ROUNDING: f64 = 1e-9;
/// The default maximum of knots is this number...
pub(super) const KNOTS_MAX: usize = 20_000;
/// ...but at most one knot per this number of points: two or three functions belong to a knot.
const POINTS_PER_KNOT: u64 = 4;
/// If a search without limits of the user would need more knots, a grid predicts better and takes less time.
const KNOTS_MAX_FIRST: usize = 5_000;
/// This grid: terrain needs several functions for each point.
const FINE: GridSize = GridSize { step: 0.5, knots_max: 600_000.0 };
/// Knots of a grid for each place of points, at most: four where no part of the box is empty. Without this
/// limit, a thousand points at one place, with some far away, would take as many knots as a million points.
const KNOTS_PER_PLACE: f64 = 16.0;
/// The grid over which the smoothing is chosen, which takes many solutions. What these knots cannot follow
/// counts as noise, and a little more smoothing predicts a little better.
const CHOICE: GridSize = GridSize { step: 1.0, knots_max: 100_000.0 };
/// The grid of robust fits, which take many solutions, too.
const ROBUST: GridSize = GridSize { step: 0.7, knots_max: 300_000.0 };

/// The size of a grid of knots.
#[derive(Debug, Clone, Copy)]
struct GridSize {
    /// Sides of its cells, in distances of points...
    step: f64,
    /// ...unless it had more knots than this.
    knots_max: f64,
}

impl GridSize {
    /// The side of cells over a box with this area, for points that are spread like this.
    fn side(&self, area: f64, spread: Spacing) -> f64 {
        let knots_max = self.knots_max.min(KNOTS_PER_PLACE * spread.places);
        (self.step * spread.distance).max((area / knots_max).sqrt())
    }
}

/// A spline that was fitted.
#[derive(Debug)]
pub struct Fitted {
    /// The spline.
    pub spline: Spline,
    /// A report of the fit.
    pub report: Report,
    robust: Option<RobustFit>,
}

/// The report of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Points of the input.
    pub points: u64,
    /// The search for knots; `None` if they were given or on a grid.
    pub search: Option<Search>,
    /// The smoothing and the reason for it; `None` if values were interpolated.
    pub chosen: Option<SmoothingChoice>,
    /// Of a robust fit: the standard deviation of a point of weight one, and whether coefficients converged.
    pub scale: Option<(f64, bool)>,
    /// Residuals of the points.
    pub residuals: Statistics,
}

/// A search for knots.
#[derive(Debug, Clone, PartialEq)]
pub struct Search {
    /// The goal of the search.
    pub goal: Goal,
    /// Its rounds.
    pub rounds: Vec<Round>,
    /// Whether all residuals are within the tolerance.
    pub is_reached: bool,
    /// Whether knots on a grid replaced those of the search, because the tolerance was not reached.
    pub is_replaced: bool,
}

/// Fits a spline to points. `done` gets the number of points read so far, in all passes together.
///
/// If no knots are given, they are on a grid with `options.step`, and otherwise the fit searches for them.
/// Over points as knots, functions are quadratic and the border is pulled apart, so that the domain is the
/// convex hull.
///
/// # Errors
/// Usage, if options exclude each other, or points do not determine the spline; those of reading.
pub fn fit(
    points: &Points,
    knots: Option<(Opened, String)>,
    options: &Options,
    done: &dyn Fn(u64),
) -> Result<Fitted> {
    if options.interpolates && (options.loss.is_some() || options.smoothing.is_some()) {
        let what = "a spline that interpolates is not smoothed, and has no residuals to weigh: leave out \
                    --interpolate, or --lambda and --robust";
        return Err(Error::usage(what));
    }
    let (mut layout, mut found) = match (knots, options.step) {
        (Some((source, name)), _) => (given_knots::layout(source, &name, options)?, None),
        (None, Some(side)) => (even(points, options, side, done)?, None),
        (None, None) => search(points, options, done).map(|(layout, search)| (layout, Some(search)))?,
    };
    let mut settled = None;
    if let Some(search) = found.as_mut().filter(|search| !search.is_reached && is_automatic(options))
        && let Some(finer) = finer_grid(points, options, layout.places(), done)?
    {
        search.is_replaced = true;
        (layout, settled) = finer;
    }
    layout.frame.join(points.crs())?;
    let frame = layout.frame.clone();
    let all = points.in_frame(&frame, done);
    let are_given = found.is_none() && options.step.is_none();
    let (coefficients, chosen, robust) = match options.interpolates {
        true => (interpolate(&layout, &all)?, None, None),
        false => {
            let with = settled.as_ref().map(|chosen| settled_by(chosen, options));
            let fitted = approximate(&layout, &all, with.as_ref().unwrap_or(options), are_given);
            let (coefficients, chosen, robust) = fitted.map_err(|error| error.of_input(points.name()))?;
            let choice = settled.and_then(|chosen| chosen.choice).or(chosen.choice);
            (coefficients, Some(SmoothingChoice { choice, ..chosen }), robust)
        }
    };
    let spline = Spline { layout, coefficients };
    let is_rejected = |found: &Residual| robust.as_ref().is_some_and(|fit| fit.is_rejected(found));
    let residuals = Statistics::of(&spline, points, is_rejected, options.threads, done)?;
    let scale = robust.as_ref().map(|fit| (fit.scale, fit.has_converged));
    let report = Report { points: points.count(), search: found, chosen, scale, residuals };
    Ok(Fitted { spline, report, robust })
}

impl Fitted {
    /// Writes the rejected points, as lines of x, y, elevation and residual. Returns their number, which is
    /// zero if the fit is not robust.
    ///
    /// # Errors
    /// If points cannot be read, or the list cannot be written.
    pub fn write_rejected(&self, points: &Points, options: &Options, output: &mut impl Write) -> Result<u64> {
        let Some(robust) = &self.robust else { return Ok(0) };
        statistics::write_rejected(robust, &self.spline, points, options.threads, output)
    }
}

/// Searches for knots.
fn search(points: &Points, options: &Options, done: &dyn Fn(u64)) -> Result<(Layout, Search)> {
    check_degree(options)?;
    let most = if is_automatic(options) { KNOTS_MAX_FIRST } else { KNOTS_MAX };
    let own_max = (points.count() / POINTS_PER_KNOT).min(most as u64) as usize;
    // At a constant elevation, residuals are its rounding errors.
    let [low, high] = points.range();
    let rounding = ROUNDING * low.abs().max(high.abs());
    let own_tolerance = (TOLERANCE_PART * (high - low)).max(rounding).max(f64::MIN_POSITIVE);
    let goal = Goal {
        loss: options.loss,
        ..Goal::new(
            options.tolerance.unwrap_or(own_tolerance),
            options.max_knots.unwrap_or(own_max.max(KNOTS_MIN)),
        )
    };
    let frame = Frame::world(points.crs().clone());
    let all = points.in_frame(&frame, done);
    let refined = fitting::refine(&all, &goal, options.threads).map_err(|e| e.of_input(points.name()))?;
    let search = Search { goal, rounds: refined.rounds, is_reached: refined.is_reached, is_replaced: false };
    let space = match options.polylines.is_empty() {
        true => refined.space,
        false => breaklines::space(refined.space.mesh.points(), options)?,
    };
    Ok((Layout::of_space(space, frame), search))
}

/// Whether knots are found without any limits of the user.
fn is_automatic(options: &Options) -> bool {
    options.tolerance.is_none() && options.max_knots.is_none()
}

/// Knots on a grid that follows from the distance of points, with the smoothing chosen over another one, if
/// it is to be chosen; `None` if the grid had fewer than `known` knots.
fn finer_grid(
    points: &Points,
    options: &Options,
    known: usize,
    done: &dyn Fn(u64),
) -> Result<Option<(Layout, Option<SmoothingChoice>)>> {
    let frame = Frame::world(points.crs().clone());
    let all = points.in_frame(&frame, done);
    let [lower, upper] = fitting::bounds(&all).map_err(|error| error.of_input(points.name()))?;
    let (area, spread) = ((upper[0] - lower[0]) * (upper[1] - lower[1]), fitting::spacing(&all)?);
    let grid = |size: GridSize| {
        let side = size.side(area, spread);
        if area / (side * side) < known as f64 {
            return Ok(None);
        }
        even(points, options, side, done).map(Some)
    };
    if options.loss.is_some() || options.interpolates {
        return Ok(grid(ROBUST)?.map(|layout| (layout, None)));
    }
    let settled = match options.smoothing {
        Some(Smoothing::Lambda(_)) => None,
        _ => grid(CHOICE)?.map(|coarse| chosen_over(&coarse, points, options, done)).transpose()?,
    };
    Ok(grid(FINE)?.map(|layout| (layout, settled)))
}

/// The smoothing chosen over these knots.
fn chosen_over(
    layout: &Layout,
    points: &Points,
    options: &Options,
    done: &dyn Fn(u64),
) -> Result<SmoothingChoice> {
    let problem = choose_smoothing(layout, &points.in_frame(&layout.frame, done), options, false);
    Ok(problem.map_err(|error| error.of_input(points.name()))?.chosen)
}

fn settled_by(chosen: &SmoothingChoice, options: &Options) -> Options {
    let smoothing = Some(Smoothing::Lambda(chosen.lambda));
    Options { smoothing, tension: Some(chosen.tension), ..options.clone() }
}

/// Places knots on a grid with cells of a given side.
fn even(points: &Points, options: &Options, side: f64, done: &dyn Fn(u64)) -> Result<Layout> {
    check_degree(options)?;
    let frame = Frame::world(points.crs().clone());
    let all = points.in_frame(&frame, done);
    let places = fitting::grid_knots(&all, side).map_err(|error| error.of_input(points.name()))?;
    let space = match options.polylines.is_empty() {
        true => SplineSpace::of(places)?,
        false => breaklines::space(&places, options)?,
    };
    Ok(Layout::of_space(space, frame))
}

fn check_degree(options: &Options) -> Result<()> {
    match options.degree.filter(|&degree| degree != 2) {
        Some(degree) => Err(Error::usage(format!(
            "knots for splines of degree {degree} must be given as configurations: use configgen"
        ))),
        None => Ok(()),
    }
}

/// Coefficients by least squares, with smoothing or robust weights.
fn approximate(
    layout: &Layout,
    all: &PointsInFrame,
    options: &Options,
    are_given: bool,
) -> Result<(Vec<f64>, SmoothingChoice, Option<RobustFit>)> {
    let problem = choose_smoothing(layout, all, options, are_given)?;
    let Some(loss) = options.loss else {
        let Solution { coefficients, has_converged } = problem.solve(&layout.basis)?;
        return Ok((coefficients, SmoothingChoice { is_solved: has_converged, ..problem.chosen }, None));
    };
    let Problem { normal, energy, lambda, chosen, start } = problem;
    let (basis, energy, threads) = (&layout.basis, energy.as_ref(), options.threads);
    let robust = match start {
        Some(start) => fitting::robust_on(start, basis, all, loss, energy, lambda, threads)?,
        None => fitting::robust(&normal, basis, all, loss, energy, lambda, threads)?,
    };
    let chosen = SmoothingChoice { is_solved: robust.is_solved, ..chosen };
    Ok((robust.coefficients.clone(), chosen, Some(robust)))
}

/// Coefficients of the spline that interpolates the triangulated points at Greville sites.
fn interpolate(layout: &Layout, all: &PointsInFrame) -> Result<Vec<f64>> {
    let (mut reader, mut held) = (all.read()?, Vec::new());
    let mut known = None;
    while known != Some(held.len()) {
        known = Some(held.len());
        reader.append(&mut held)?;
    }
    let (places, values): (Vec<_>, Vec<f64>) =
        held.into_iter().map(|one: Observation| (one.point, one.value)).unzip();
    Interpolation::new(&layout.basis)?.of_points(&Mesh::of(places)?, &values)
}

//! From points and knots to coefficients.

use std::io::Write;

use super::anisotropy::Stretch;
use super::automatic::{Found, Levels};
use super::certainty::Certainty;
use super::frame::Frame;
use super::layout::{Layout, Spline};
use super::options::{Options, Smoothing};
use super::points::{Points, PointsInFrame};
use super::smoothing_choice::{Problem, SmoothingChoice, choose_smoothing};
use super::statistics::Statistics;
use super::validation::Prediction;
use super::{automatic, given_knots, statistics};
use crate::bases::Scratch;
use crate::fitting::{
    self, Goal, Interpolation, KNOTS_MIN, Mesh, Observation, Observations, Residual, RobustFit, Round,
    Solution,
};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_formats::source::Opened;

/// The default tolerance, as a part of the range of elevations.
const TOLERANCE_PART: f64 = 0.0025;
/// Residuals below this part of the greatest magnitude of elevations are rounding errors.
const ROUNDING: f64 = 1e-9;
/// The default maximum of knots is this number...
pub(super) const KNOTS_MAX: usize = 20_000;
/// ...but at most one knot per this number of points: two or three functions belong to a knot.
const POINTS_PER_KNOT: u64 = 4;

/// A spline that was fitted.
#[derive(Debug)]
pub struct Fitted {
    /// The spline.
    pub spline: Spline,
    /// A report of the fit.
    pub report: Report,
    robust: Option<RobustFit>,
    errors: Option<Errors>,
}

/// The errors of a spline, with the layout that they are those of: before it was moved or restricted.
#[derive(Debug)]
struct Errors {
    certainty: Certainty,
    own: Option<Spline>,
}

/// The report of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Points of the input.
    pub points: u64,
    /// Their places, and the deviation of points of one place, if any have the same.
    pub sites: Option<(u64, Option<f64>)>,
    /// The search for knots within a tolerance or a number of knots, if there was one.
    pub search: Option<Search>,
    /// The levels of knots, if there was no other search, and knots were not given.
    pub levels: Option<Levels>,
    /// How coordinates were stretched, if they were.
    pub stretch: Option<Stretch>,
    /// Why a search for knots failed, if levels replace it.
    pub failure: Option<String>,
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
    let are_given = knots.is_some();
    let is_own_choice = are_given || options.step.is_some() || !is_automatic(options);
    let stretch = match options.anisotropy {
        None if is_own_choice => Stretch::NONE,
        _ => automatic::stretch(points, options, done)?,
    };
    let world = Frame::stretched(points.crs().clone(), stretch);
    let Placed { mut layout, search, found, failure } = placed(points, knots, options, &world, done)?;
    let (levels, settled, inner) = match found {
        Some((levels, settled, inner)) => (Some(levels), settled, inner),
        None => (None, None, None),
    };
    let distance = levels.as_ref().map(|levels| levels.distance);
    let options = &Options { distance, ..options.clone() };
    layout.frame.join(points.crs())?;
    let frame = layout.frame.clone();
    // Robust weights are those of points, and interpolation takes the first one of each place.
    let is_merged = levels.is_some() && options.loss.is_none();
    let all = if is_merged { points.sites_in_frame(&frame, done) } else { points.in_frame(&frame, done) };
    let (coefficients, chosen, robust, certainty) = match options.interpolates {
        true => (interpolate(&layout, &all)?, None, None, None),
        false => {
            let Approximation { coefficients, mut chosen, robust, certainty } =
                approximate(&layout, &all, settled, options, are_given)
                    .map_err(|error| error.of_input(points.name()))?;
            chosen.tension *= unit_of_tension(inner.as_ref().unwrap_or(&layout), points, options);
            (coefficients, Some(chosen), robust, certainty)
        }
    };
    let (spline, own) = finished(layout, coefficients, inner, points, options)?;
    let errors = certainty.map(|certainty| Errors { certainty, own });
    let is_rejected = |found: &Residual| robust.as_ref().is_some_and(|fit| fit.is_rejected(found));
    let residuals = Statistics::of(&spline, points, is_rejected, options.threads, done)?;
    let scale = robust.as_ref().map(|fit| (fit.scale, fit.has_converged));
    let stretch = (stretch.ratio != 1.0).then_some(stretch);
    let sites = points.sites().filter(|_| is_merged).map(|sites| (sites.count(), sites.pure_error));
    let report =
        Report { points: points.count(), sites, search, levels, stretch, failure, chosen, scale, residuals };
    Ok(Fitted { spline, report, robust, errors })
}

/// The spline in world coordinates on its final domain, and what it was before if that is another one.
fn finished(
    layout: Layout,
    coefficients: Vec<f64>,
    inner: Option<Layout>,
    points: &Points,
    options: &Options,
) -> Result<(Spline, Option<Spline>)> {
    let Some(inner) = inner else {
        return Ok(match layout.unstretched()? {
            None => (Spline::new(layout, coefficients), None),
            Some(moved) => {
                (Spline::new(moved, coefficients.clone()), Some(Spline::new(layout, coefficients)))
            }
        });
    };
    let sites = points.places()?.0.into_iter().map(|place| layout.frame.to_stored(place));
    let found = fitting::projected((&layout.basis, &coefficients), &inner.basis, sites, options.threads)?;
    let inner = Layout { frame: layout.frame.clone(), ..inner };
    Ok((Spline::new(inner.unstretched()?.unwrap_or(inner), found), Some(Spline::new(layout, coefficients))))
}

/// Knots with their functions, and where they come from.
struct Placed {
    layout: Layout,
    search: Option<Search>,
    /// The levels of automatic knots, their smoothing, and the knots of the smaller domain in the end.
    found: Option<(Levels, Option<SmoothingChoice>, Option<Layout>)>,
    /// Why a search failed.
    failure: Option<String>,
}

fn placed(
    points: &Points,
    knots: Option<(Opened, String)>,
    options: &Options,
    world: &Frame,
    done: &dyn Fn(u64),
) -> Result<Placed> {
    let of = |layout| Placed { layout, search: None, found: None, failure: None };
    let failure = match (knots, options.step) {
        (Some((source, name)), _) => return given_knots::layout(source, &name, options).map(of),
        (None, Some(side)) => return even(points, options, side, world, done).map(of),
        (None, None) if is_automatic(options) => None,
        (None, None) => match search(points, options, world, done)? {
            Ok((layout, search)) => return Ok(Placed { search: Some(search), ..of(layout) }),
            Err(reason) => Some(reason),
        },
    };
    let Found { layout, settled, levels, inner, .. } = automatic::find(points, options, world, done)?;
    Ok(Placed { layout, search: None, found: Some((levels, settled, inner)), failure })
}

impl Fitted {
    /// What its errors follow from: a layout with coefficients, and their certainty.
    ///
    /// # Errors
    /// Usage, if the options did not ask for errors, or the spline has none.
    pub(super) fn errors(&self) -> Result<(&Layout, &[f64], &Certainty)> {
        let Some(Errors { certainty, own }) = &self.errors else {
            return Err(Error::usage("robust and interpolating splines have no standard errors"));
        };
        let Spline { layout, coefficients, .. } = own.as_ref().unwrap_or(&self.spline);
        Ok((layout, coefficients, certainty))
    }

    /// The prediction of a point of some weight; `None` outside of the domain. Its error is NaN if there is
    /// none.
    pub(super) fn prediction(&self, one: &Observation, scratch: &mut Scratch) -> Option<Prediction> {
        let Observation { point: place, value, weight } = *one;
        let Layout { basis, frame, .. } = &self.spline.layout;
        let at = frame.to_stored(place);
        let predicted =
            basis.is_in_domain(at).then(|| basis.value(&self.spline.coefficients, at, scratch))?;
        let (mut error, mut half) = (f64::NAN, f64::NAN);
        if let Ok((layout, _, certainty)) = self.errors() {
            let own = certainty.standard_error(layout.basis.at(layout.frame.to_stored(place), scratch));
            error = own.hypot(certainty.noise / weight.sqrt());
            half = certainty.width * error;
        }
        Some(Prediction { place, value, predicted, error, half })
    }

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

/// Searches for knots. The inner error is the reason why a search in range found none: its knots can be where
/// points do not determine a spline.
fn search(
    points: &Points,
    options: &Options,
    frame: &Frame,
    done: &dyn Fn(u64),
) -> Result<std::result::Result<(Layout, Search), String>> {
    check_degree(options)?;
    let own_max = (points.count() / POINTS_PER_KNOT).min(KNOTS_MAX as u64) as usize;
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
    let all = points.in_frame(frame, done);
    goal.check()?;
    let refined = match fitting::refine(&all, &goal, options.threads) {
        Err(error) if error.kind() == ErrorKind::Usage => return Ok(Err(error.to_string())),
        found => found.map_err(|error| error.of_input(points.name()))?,
    };
    let search = Search { goal, rounds: refined.rounds, is_reached: refined.is_reached };
    let layout = match options.polylines.is_empty() && frame.stretch().is_none() {
        true => Layout::of_space(refined.space, frame.clone()),
        false => Layout::even(refined.space.mesh.points().to_vec(), options, frame)?,
    };
    Ok(Ok((layout, search)))
}

/// Whether knots are found without any limits of the user.
fn is_automatic(options: &Options) -> bool {
    options.tolerance.is_none() && options.max_knots.is_none()
}

fn settled_by(chosen: &SmoothingChoice, options: &Options) -> Options {
    let smoothing = Some(Smoothing::Lambda(chosen.lambda));
    Options { smoothing, tension: Some(chosen.tension), ..options.clone() }
}

/// The documented unit of tensions, one over the root of the area of a point, in units of a fit that knows
/// the typical distance of points.
fn unit_of_tension(layout: &Layout, points: &Points, options: &Options) -> f64 {
    let Some(distance) = options.distance else { return 1.0 };
    (fitting::domain_area(&layout.basis) / points.count() as f64).sqrt() / distance
}

/// Places knots on a grid with cells of a given side.
fn even(points: &Points, options: &Options, side: f64, frame: &Frame, done: &dyn Fn(u64)) -> Result<Layout> {
    check_degree(options)?;
    let all = points.in_frame(frame, done);
    let places = fitting::grid_knots(&all, side).map_err(|error| error.of_input(points.name()))?;
    Layout::even(places, options, frame)
}

pub(super) fn check_degree(options: &Options) -> Result<()> {
    match options.degree.filter(|&degree| degree != 2) {
        Some(degree) => Err(Error::usage(format!(
            "knots for splines of degree {degree} must be given as configurations: use configgen"
        ))),
        None => Ok(()),
    }
}

/// Coefficients with what they follow from.
struct Approximation {
    coefficients: Vec<f64>,
    chosen: SmoothingChoice,
    robust: Option<RobustFit>,
    /// If it is wanted, and the fit is not robust.
    certainty: Option<Certainty>,
}

/// Coefficients by least squares, with robust weights or a smoothing, which may be settled.
fn approximate(
    layout: &Layout,
    all: &PointsInFrame,
    settled: Option<SmoothingChoice>,
    options: &Options,
    are_given: bool,
) -> Result<Approximation> {
    let with = settled.as_ref().map(|chosen| settled_by(chosen, options));
    let mut problem = choose_smoothing(layout, all, with.as_ref().unwrap_or(options), are_given)?;
    if let Some(settled) = settled {
        problem.chosen = settled;
    }
    let Some(loss) = options.loss else {
        let Solution { coefficients, has_converged } = problem.solve(&layout.basis)?;
        let certainty = match options.wants_errors {
            true => {
                let found = problem.certainty(&layout.basis)?;
                Some(found.calibrated(&layout.basis, &coefficients, all, options.threads)?)
            }
            false => None,
        };
        let chosen = SmoothingChoice { is_solved: has_converged, ..problem.chosen };
        return Ok(Approximation { coefficients, chosen, robust: None, certainty });
    };
    let Problem { normal, energy, lambda, chosen, start } = problem;
    let (basis, energy, threads) = (&layout.basis, energy.as_ref(), options.threads);
    let robust = match start {
        Some(start) => fitting::robust_on(start, basis, all, loss, energy, lambda, threads)?,
        None => fitting::robust(&normal, basis, all, loss, energy, lambda, threads)?,
    };
    let chosen = SmoothingChoice { is_solved: robust.is_solved, ..chosen };
    let coefficients = robust.coefficients.clone();
    Ok(Approximation { coefficients, chosen, robust: Some(robust), certainty: None })
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

//! Knots without any flags: as many as the points tell more than noise.
//!
//! Knots follow the density of points. Each level halves the distance of knots, and its smoothing is chosen
//! anew. The levels end where a finer one predicts no better, as generalised cross-validation tells, and
//! residuals of neighbours are unlike each other: what is left is noise. If no level is enough, there are
//! about four knots for each point, with the smoothing chosen over one for each point.

use super::anisotropy::{ASPECT_MAX, Anisotropy, Stretch};
use super::fit::check_degree;
use super::frame::Frame;
use super::layout::Layout;
use super::options::{Options, Smoothing};
use super::points::Points;
use super::smoothing_choice::{SmoothingChoice, choose_smoothing};
use crate::fitting::{self, Density, Placement};
use spmesh_base::error::{ErrorKind, Result};
use spmesh_delaunay::predicates::Point2;

/// Sides of cells of the levels, in typical distances of points.
const STEPS: [f64; 3] = [8.0, 4.0, 2.0];
/// The grid over which the smoothing is chosen if no level is enough. What these knots cannot follow counts
/// as noise, and a little more smoothing predicts a little better.
const CHOICE: GridSize = GridSize { step: 1.0, knots_max: 100_000 };
/// The grid after this choice: terrain needs several functions for each point.
const FINE: GridSize = GridSize { step: 0.5, knots_max: 600_000 };
/// The grid of robust fits, which take many solutions.
const ROBUST: GridSize = GridSize { step: 0.7, knots_max: 300_000 };
/// The grid of trials of stretches.
const TRIAL: GridSize = GridSize { step: 1.0, knots_max: 1_500 };
/// The first ratio that is tried, and the greatest one of a box that is not made square first.
const RATIO_FIRST: f64 = 2.0;
/// With a greater ratio of sides, a square box is tried. It must predict better by this part, as of
/// coordinates in different units.
const ASPECT: f64 = 3.0;
const SQUARE_GAIN: f64 = 0.2;
/// Fewer points do not tell.
const SQUARE_POINTS: u64 = 30;
/// How far the domain reaches beyond the hull of points, in their typical distances.
const WIDENED: f64 = 0.5;
/// A plate is free far around points, not along their hull: it bends less in gaps. So it is fitted over a
/// domain that reaches farther, by this part of the longer side of the box of points, and then cut to the
/// hull; if there are at most so many places, of which a good part is near to the hull.
const REACH: f64 = 1.0;
const REACH_MAX: usize = 20_000;
/// This part of places is a good part, and these are near: within so many of their typical distances.
const NEAR_PART: f64 = 0.6;
const NEAR: f64 = 1.0;
/// Knots for each place, at most.
const KNOTS_PER_PLACE: usize = 16;
/// Knots of a level, at least: fewer tell nothing.
const KNOTS_MIN: f64 = 64.0;
/// A finer level must make the score less by this part.
const GAIN: f64 = 0.002;
/// If the last level makes it less by no more than this part, the next one would by less than the part above:
/// errors of what knots cannot follow fall to a quarter, at least.
const GAIN_LAST: f64 = 4.0 * GAIN;
/// Residuals of neighbours are alike if their correlation is greater, and greater than so many deviations of
/// a chance.
const CORRELATION: f64 = 0.05;
const DEVIATIONS: f64 = 3.0;
/// Residuals are rounding errors if their root mean square is at most so many units in the last place of
/// values, and of what coordinates in their last place change them: the equations lose some digits.
const ROUNDINGS: f64 = 4096.0;
/// So few places are on a plane, or nearly.
const PLANE: usize = 3;

#[derive(Debug, Clone, Copy)]
struct GridSize {
    step: f64,
    knots_max: usize,
}

/// How knots were found.
#[derive(Debug, Clone, PartialEq)]
pub struct Levels {
    /// The levels, from coarse to fine.
    pub levels: Vec<Level>,
    /// Why there are no more of them.
    pub stop: Stop,
    /// The typical distance of points. Units: those of the world.
    pub distance: f64,
}

/// Why knots do not become denser.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// A finer level predicts no better: residuals are noise.
    Noise,
    /// Residuals are rounding errors of the values.
    Rounding,
    /// Knots are as dense as points allow.
    Density,
    /// So few points, or options, leave nothing to compare.
    Given,
}

/// The fit over the knots of one level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// Sides of cells, in typical distances of points.
    pub step: f64,
    /// Places of knots.
    pub knots: usize,
    /// The chosen smoothing, in world coordinates.
    pub lambda: f64,
    /// The score of generalised cross-validation.
    pub score: f64,
    /// The standard deviation of points of weight one.
    pub noise: f64,
    /// The root of the mean square of residuals; NaN if points are not held in memory.
    pub residual: f64,
    /// The correlation of residuals of neighbours; NaN if points are not held in memory.
    pub correlation: f64,
}

/// Knots, with their smoothing if it is chosen already.
pub(super) struct Found {
    pub(super) layout: Layout,
    size: GridSize,
    pub(super) settled: Option<SmoothingChoice>,
    pub(super) levels: Levels,
    /// The knots of the smaller domain that the spline is to have in the end.
    pub(super) inner: Option<Layout>,
}

struct Search<'a> {
    points: &'a Points,
    options: &'a Options,
    frame: &'a Frame,
    done: &'a dyn Fn(u64),
    density: Density,
    /// Neighbours follow each other; empty if not all points are held.
    order: Vec<u32>,
    /// How far beyond the box of points the domain of the fit reaches.
    reach: f64,
    /// Residuals up to this one are rounding errors.
    rounding: f64,
}

/// Finds knots, in a frame.
///
/// # Errors
/// Points that span no area, or do not determine a spline; those of reading.
pub(super) fn find(points: &Points, options: &Options, frame: &Frame, done: &dyn Fn(u64)) -> Result<Found> {
    check_degree(options)?;
    Search::new(points, options, frame, done)?.run()
}

/// How coordinates are to be stretched.
///
/// # Errors
/// As [`find`].
pub(super) fn stretch(points: &Points, options: &Options, done: &dyn Fn(u64)) -> Result<Stretch> {
    let bounds = || {
        let world = Frame::world(points.crs().clone());
        fitting::bounds(&points.in_frame(&world, done)).map_err(|error| error.of_input(points.name()))
    };
    let margin = options.widen.unwrap_or(0.0);
    match options.anisotropy {
        Some(Anisotropy::Ratio(ratio, angle)) => Ok(Stretch::new(ratio, angle, bounds()?, margin)),
        Some(Anisotropy::Rescale) => Stretch::of_box(bounds()?, margin),
        Some(Anisotropy::Auto) => likeliest_stretch(points, options, bounds()?, done),
        // Features are given in coordinates that are not stretched.
        None if !options.polylines.is_empty() => Ok(Stretch::NONE),
        None => {
            let whole = Stretch::of_box(bounds()?, margin)?;
            let is_within = |most: f64| (1.0 / most..=most).contains(&whole.ratio);
            match (is_within(ASPECT), is_within(ASPECT_MAX)) {
                (true, _) => Ok(Stretch::NONE),
                (_, false) => Ok(whole),
                _ if options.loss.is_some() || points.count() < SQUARE_POINTS => Ok(Stretch::NONE),
                _ => {
                    let [own, square] = [Stretch::NONE, whole].map(|one| score(one, points, options, done));
                    Ok(if square? < (1.0 - SQUARE_GAIN) * own? { whole } else { Stretch::NONE })
                }
            }
        }
    }
}

/// How well a spline predicts in stretched coordinates, by generalised cross-validation.
fn score(stretch: Stretch, points: &Points, options: &Options, done: &dyn Fn(u64)) -> Result<f64> {
    let frame = Frame::stretched(points.crs().clone(), stretch);
    let search = Search::new(points, options, &frame, done)?;
    let (chosen, _) = search.chosen(&search.grid(TRIAL)?, Some(0.0))?;
    Ok(chosen.quality.map_or(f64::INFINITY, |quality| quality.score))
}

/// The stretch with the least score of generalised cross-validation: ratios are doubled from that of the box
/// or of none on, along directions that are then refined.
///
/// Cost: about twenty choices of a smoothing over a few thousand knots at most.
fn likeliest_stretch(
    points: &Points,
    options: &Options,
    bounds: [Point2; 2],
    done: &dyn Fn(u64),
) -> Result<Stretch> {
    let margin = options.widen.unwrap_or(0.0);
    let whole = Stretch::of_box(bounds, margin)?;
    let of = |ratio, angle| Stretch::new(ratio, angle, bounds, margin);
    let score = |stretch| score(stretch, points, options, done);
    let mut best = (score(Stretch::NONE)?, Stretch::NONE);
    let attempt = |stretch: Stretch, best: &mut (f64, Stretch)| -> Result<bool> {
        let found = score(stretch)?;
        let is_better = found < (1.0 - GAIN) * best.0;
        if is_better {
            *best = (found, stretch);
        }
        Ok(is_better)
    };
    // Directions in coordinates that make the box square would not be directions of the world.
    if !(1.0 / RATIO_FIRST..=RATIO_FIRST).contains(&whole.ratio) {
        attempt(whole, &mut best)?;
    }
    let scaled = best.1.ratio;
    if scaled == 1.0 {
        for angle in [0.0, 45.0, 90.0, 135.0] {
            attempt(of(RATIO_FIRST, angle), &mut best)?;
        }
        for by in [22.5, 11.25] {
            let angle = best.1.angle;
            for angle in [angle - by, angle + by] {
                if best.1.ratio == 1.0 {
                    break;
                }
                attempt(of(best.1.ratio, angle), &mut best)?;
            }
        }
    }
    for factor in [2.0, 0.5, 2f64.sqrt(), 0.5f64.sqrt()] {
        while best.1.ratio != 1.0 && attempt(of(factor * best.1.ratio, best.1.angle), &mut best)? {}
    }
    Ok(best.1)
}

impl<'a> Search<'a> {
    fn new(
        points: &'a Points,
        options: &'a Options,
        frame: &'a Frame,
        done: &'a dyn Fn(u64),
    ) -> Result<Search<'a>> {
        let (mut places, share) = points.places()?;
        let rounding = ROUNDINGS * f64::EPSILON * magnitude(&places, points.range());
        places.iter_mut().for_each(|place| *place = frame.to_stored(*place));
        let density = Density::of(places, share).map_err(|error| error.of_input(points.name()))?;
        let density = density.on_grid(frame.grid_step());
        let order = if share == 1.0 { density.order() } else { Vec::new() };
        let is_small = density.places().len() <= REACH_MAX && !order.is_empty();
        let is_plain = options.loss.is_none() && options.polylines.is_empty() && !options.interpolates;
        let is_wide =
            is_small && is_plain && density.part_near_border(NEAR * density.distance()) >= NEAR_PART;
        let reach = if is_wide { REACH * density.extent() } else { 0.0 };
        Ok(Search { points, options, frame, done, density, order, reach, rounding })
    }

    fn run(&self) -> Result<Found> {
        let found = self.find()?;
        let inner = (self.reach > 0.0).then(|| self.placed(found.size, 0.0)).transpose()?;
        Ok(Found { inner, ..found })
    }

    fn find(&self) -> Result<Found> {
        let places = self.density.places().len();
        let given = |size, settled| {
            let levels = self.levels(Vec::new(), Stop::Given);
            Ok(Found { layout: self.grid(size)?, size, settled, levels, inner: None })
        };
        if self.options.loss.is_some() {
            return given(ROBUST, None);
        }
        if places <= PLANE {
            return given(CHOICE, Some(self.plane()));
        }
        match self.options.smoothing {
            Some(Smoothing::Lambda(_)) => return given(FINE, None),
            Some(Smoothing::Folds(_)) => {
                let (chosen, _) = self.chosen(&self.grid(CHOICE)?, self.options.tension)?;
                return given(FINE, Some(chosen));
            }
            None | Some(Smoothing::Likelihood | Smoothing::Generalised) => (),
        }
        self.by_levels(places)
    }

    fn by_levels(&self, places: usize) -> Result<Found> {
        let count = if self.order.is_empty() { self.points.count() as f64 } else { places as f64 };
        let is_useful = |step: &f64| (KNOTS_MIN..CHOICE.knots_max as f64).contains(&(count / (step * step)));
        let mut all: Vec<Level> = Vec::new();
        let mut best: Option<(Level, Layout, SmoothingChoice)> = None;
        for step in STEPS.into_iter().filter(is_useful).chain([CHOICE.step]) {
            let layout = self.grid(GridSize { step, ..CHOICE })?;
            let is_last = step == CHOICE.step;
            // A smooth spline has no tension: only the last level tries others.
            let tension = self.options.tension.or((!is_last).then_some(0.0));
            let (chosen, coefficients) = match self.chosen(&layout, tension) {
                // The next level may do.
                Err(error) if error.kind() == ErrorKind::Usage && !is_last => continue,
                found => found?,
            };
            let level = self.level(step, &layout, &chosen, &coefficients)?;
            all.push(level);
            if level.residual <= self.rounding {
                let (size, levels) = (GridSize { step, ..CHOICE }, self.levels(all, Stop::Rounding));
                return Ok(Found { layout, size, settled: Some(chosen), levels, inner: None });
            }
            let noise = |step, layout, chosen, all| {
                let (size, levels) = (GridSize { step, ..CHOICE }, self.levels(all, Stop::Noise));
                Ok(Found { layout, size, settled: Some(chosen), levels, inner: None })
            };
            match best {
                Some((known, layout, chosen)) if self.ends_at(&known, level.score) => {
                    return noise(known.step, layout, chosen, all);
                }
                Some((known, ..))
                    if is_last && level.score >= (1.0 - GAIN_LAST) * known.score && self.is_noise(&level) =>
                {
                    return noise(step, layout, chosen, all);
                }
                Some((known, ..)) if known.score <= level.score && !is_last => (),
                _ => best = Some((level, layout, chosen)),
            }
        }
        let settled = best.map(|(.., chosen)| chosen);
        let levels = self.levels(all, Stop::Density);
        Ok(Found { layout: self.grid(FINE)?, size: FINE, settled, levels, inner: None })
    }

    fn levels(&self, levels: Vec<Level>, stop: Stop) -> Levels {
        Levels { levels, stop, distance: self.density.distance() }
    }

    /// Whether the best level so far leaves only noise, which a finer one with this score shows.
    fn ends_at(&self, best: &Level, score: f64) -> bool {
        score >= (1.0 - GAIN) * best.score && self.is_noise(best)
    }

    /// Whether residuals of neighbours are unlike each other.
    fn is_noise(&self, level: &Level) -> bool {
        let by_chance = DEVIATIONS / (self.order.len().max(1) as f64).sqrt();
        level.correlation.is_nan() || level.correlation < by_chance.max(CORRELATION)
    }

    fn grid(&self, size: GridSize) -> Result<Layout> {
        self.placed(size, self.reach)
    }

    /// Knots over the hull of points, widened, and over all that is so far from it.
    fn placed(&self, size: GridSize, far: f64) -> Result<Layout> {
        let margin = self.options.widen.unwrap_or(WIDENED * self.density.distance());
        let few = KNOTS_PER_PLACE * self.density.places().len().max(PLANE);
        let knots_max = match self.order.is_empty() {
            true => size.knots_max,
            false => size.knots_max.min(few.max(256)),
        };
        let places = self.density.knots(Placement {
            step: size.step,
            margin: margin.max(far),
            reach: self.reach,
            knots_max,
        })?;
        Layout::even(places, self.options, self.frame)
    }

    /// The smoothing over some knots, and the coefficients.
    fn chosen(&self, layout: &Layout, tension: Option<f64>) -> Result<(SmoothingChoice, Vec<f64>)> {
        let distance = Some(self.density.distance());
        let options = Options { tension, distance, ..self.options.clone() };
        let all = self.points.sites_in_frame(&layout.frame, self.done);
        let found = choose_smoothing(layout, &all, &options, false).and_then(|problem| {
            let coefficients = problem.solve(&layout.basis)?.coefficients;
            Ok((problem.chosen, coefficients))
        });
        found.map_err(|error| error.of_input(self.points.name()))
    }

    /// A smoothing that keeps the plane through three points, of which any does.
    fn plane(&self) -> SmoothingChoice {
        let area = self.density.distance().powi(2);
        SmoothingChoice::given(area, self.options.tension.unwrap_or(0.0))
    }

    fn level(
        &self,
        step: f64,
        layout: &Layout,
        chosen: &SmoothingChoice,
        coefficients: &[f64],
    ) -> Result<Level> {
        let quality = chosen.quality.as_ref();
        let [residual, correlation] = self.residuals(layout, coefficients)?;
        Ok(Level {
            step,
            knots: layout.places(),
            lambda: chosen.lambda,
            score: quality.map_or(f64::INFINITY, |quality| quality.score),
            noise: quality.map_or(f64::NAN, |quality| quality.noise),
            residual,
            correlation,
        })
    }

    /// The root of the mean square of residuals, and the correlation of those that follow each other in
    /// order.
    fn residuals(&self, layout: &Layout, coefficients: &[f64]) -> Result<[f64; 2]> {
        if self.order.is_empty() {
            return Ok([f64::NAN; 2]);
        }
        let (mut residuals, mut square) = (vec![0.0; self.order.len()], 0.0);
        let all = self.points.sites_in_frame(&layout.frame, self.done);
        fitting::for_each_residual(&layout.basis, coefficients, &all, self.options.threads, |found| {
            residuals[found.index as usize] = found.residual * found.weight.sqrt();
            square += found.residual * found.residual;
        })?;
        let at = |index: u32| residuals[index as usize];
        let products: f64 = self.order.windows(2).map(|pair| at(pair[0]) * at(pair[1])).sum();
        let squares: f64 = residuals.iter().map(|residual| residual * residual).sum();
        let correlation = if squares > 0.0 { products / squares } else { 0.0 };
        Ok([(square / self.order.len() as f64).sqrt(), correlation])
    }
}

/// The greatest magnitude of values, plus that of what they change if coordinates change by their own size.
fn magnitude(places: &[Point2], [low, high]: [f64; 2]) -> f64 {
    let far = |axis: usize| {
        let all = || places.iter().map(|place| place[axis]);
        let [least, most] = [all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max)];
        least.abs().max(most.abs()) / (most - least)
    };
    low.abs().max(high.abs()) + (high - low) * far(0).max(far(1))
}

//! The choice of the smoothing parameter.

use super::certainty::Certainty;
use super::layout::Layout;
use super::options::{Options, Smoothing};
use super::points::PointsInFrame;
use crate::bases::Basis;
use crate::fitting::{
    self, Choice, Equations, Method, NormalEquations, Quality, RobustStart, Solution, Symmetric, Tense,
};
use spmesh_base::error::{Error, Result};

/// The smoothing of a fit, and the reason for it.
#[derive(Debug, Clone, PartialEq)]
pub struct SmoothingChoice {
    /// The factor of the thin-plate energy, in world coordinates.
    pub lambda: f64,
    /// The tension, in units of one over the distance of points.
    pub tension: f64,
    /// Number of functions that points leave undetermined without smoothing; `None` if it was not needed.
    pub undetermined: Option<usize>,
    /// Whether the equations were solved: the steps to the least energy may not get there.
    pub is_solved: bool,
    /// The trials of the choice; `lambda` in world coordinates.
    pub choice: Option<Choice>,
    /// Whether generalised cross-validation asked for more smoothing than the likelihood.
    pub is_raised: bool,
    /// How well it predicts, if `lambda` was chosen for all points at once.
    pub quality: Option<Quality>,
}

/// Generalised cross-validation overrules the likelihood if it is surer than by chance: the logarithm of the
/// ratio of scores, times the number of points, is then about a difference of Akaike's criterion.
const OVERRULING: f64 = 6.0;

/// Tensions of knots that follow density: velocities across a fault are nearly those of a membrane.
const TENSIONS: [f64; 4] = [0.0, 1.0, 2.0, 4.0];

impl SmoothingChoice {
    /// A smoothing without a reason.
    pub(super) fn given(lambda: f64, tension: f64) -> SmoothingChoice {
        SmoothingChoice {
            lambda,
            tension,
            undetermined: None,
            is_solved: true,
            choice: None,
            is_raised: false,
            quality: None,
        }
    }
}

/// Normal equations with a chosen `lambda`.
pub(super) struct Problem {
    pub(super) normal: NormalEquations,
    pub(super) energy: Option<Symmetric>,
    /// For stored coordinates.
    pub(super) lambda: f64,
    pub(super) chosen: SmoothingChoice,
    /// Where a robust fit starts, if `lambda` was chosen with robust weights.
    pub(super) start: Option<RobustStart>,
}

impl Problem {
    pub(super) fn solve(&self, basis: &Basis) -> Result<Solution> {
        let equations = Equations::new(basis, &self.normal, self.energy.as_ref())?;
        tensed(equations, self.chosen.tension).solution(self.lambda)
    }

    pub(super) fn certainty(&self, basis: &Basis) -> Result<Certainty> {
        let equations = Equations::new(basis, &self.normal, self.energy.as_ref())?;
        Certainty::new(&tensed(equations, self.chosen.tension), self.lambda)
    }
}

/// Sets up the equations of points, and chooses `lambda`. Without an option, given knots are not smoothed: if
/// points do not determine all functions, the energy counts only for the others. Other knots are smoothed by
/// restricted maximum likelihood, which also chooses the tension.
///
/// In stored coordinates, second derivatives are those of the world times the step squared, and areas are
/// those of the world divided by the step squared. So the energy is that of the world times the step squared,
/// and `lambda` is divided by the step squared.
///
/// # Errors
/// A tension where it has no meaning; those of [`NormalEquations::of`], [`fitting::bending`] and
/// [`Equations::solve`].
pub(super) fn choose_smoothing(
    layout: &Layout,
    all: &PointsInFrame,
    options: &Options,
    are_given: bool,
) -> Result<Problem> {
    let (basis, threads) = (&layout.basis, options.threads);
    let normal = NormalEquations { distance: options.distance, ..NormalEquations::of(basis, all, threads)? };
    check_tension(basis, options, are_given)?;
    let mut start = None;
    let undetermined = match options.smoothing {
        None if are_given => Some(Equations::new(basis, &normal, None)?.undetermined(0.0)?.len()),
        _ => None,
    };
    // Robust weights may leave further functions undetermined.
    let is_determined = undetermined == Some(0) && options.loss.is_none();
    let needs_none = options.smoothing == Some(Smoothing::Lambda(0.0)) || is_determined;
    let bending = if needs_none { None } else { Some(fitting::bending(basis)?) };
    let area = layout.frame.step().powi(2);
    let method = match options.smoothing {
        Some(Smoothing::Lambda(_)) => None,
        // Least squares, with the least energy where points determine nothing.
        None if are_given => None,
        None | Some(Smoothing::Likelihood) => Some(Method::Likelihood),
        Some(Smoothing::Generalised) => Some(Method::Generalised),
        Some(Smoothing::Folds(count)) => Some(Method::Folds { count, seed: options.seed }),
    };
    let own = options.tension.unwrap_or(0.0);
    let (mut is_raised, mut quality) = (false, None);
    let (energy, lambda, tension, choice) = match (bending, method, options.smoothing) {
        (Some(bending), Some(Method::Likelihood), _) if options.loss.is_none() => {
            let tensions: &[f64] = match options.tension {
                Some(own) => &[own],
                None if basis.degree() > 1 && options.distance.is_some() => &TENSIONS,
                None if basis.degree() > 1 => &fitting::TENSIONS,
                None => &[0.0],
            };
            let Tense { energy, tension, choice } =
                fitting::choose_tension(basis, &normal, bending, tensions)?;
            let equations = tensed(Equations::new(basis, &normal, Some(&energy))?, tension);
            let may_raise = options.smoothing.is_none() && options.distance.is_some();
            let (lambda, known) = raised(&equations, choice.best.lambda, may_raise)?;
            (is_raised, quality) = (lambda > choice.best.lambda, Some(known));
            drop(equations);
            (Some(energy), lambda, tension, Some(choice))
        }
        (Some(bending), Some(method), _) => {
            let choice = if options.loss.is_some() {
                let (choice, robust) =
                    fitting::choose_robustly(&normal, basis, all, &bending, method, threads)?;
                start = Some(robust);
                choice
            } else {
                let choice = fitting::choose(&normal, basis, all, &bending, method, threads)?;
                let equations = Equations::new(basis, &normal, Some(&bending))?;
                quality = Some(Quality::of(&equations, choice.best.lambda)?);
                choice
            };
            (Some(bending), choice.best.lambda, 0.0, Some(choice))
        }
        (Some(bending), None, Some(Smoothing::Lambda(lambda))) => {
            let energy = fitting::with_tension(basis, &normal, bending, own)?;
            (Some(energy), lambda / area, own, None)
        }
        (bending, ..) => (bending, 0.0, 0.0, None),
    };
    let choice = choice.map(|choice| in_world(choice, area));
    let given = SmoothingChoice::given(lambda * area, tension);
    let chosen = SmoothingChoice { undetermined, choice, is_raised, quality, ..given };
    Ok(Problem { normal, energy, lambda, chosen, start })
}

/// The likeliest `lambda`, or the one of generalised cross-validation if that is greater for a reason: the
/// likelihood takes each spline for a sample of a distribution, in which hills are as rough as bumps. A
/// smooth surface that rises by far more than its noise follows the noise. With its quality.
fn raised(equations: &Equations, likeliest: f64, may_raise: bool) -> Result<(f64, Quality)> {
    if !may_raise {
        return Ok((likeliest, Quality::of(equations, likeliest)?));
    }
    let mut trials: Vec<(f64, Quality)> = Vec::new();
    let best = fitting::generalised_cross_validation_from(equations, likeliest, |lambda, quality| {
        trials.push((lambda, quality));
    });
    // The first trial is the likeliest one.
    let Some(&own) = trials.first() else { return Ok((likeliest, Quality::of(equations, likeliest)?)) };
    // Without residuals there is no noise to follow.
    let Ok(Choice { best, .. }) = best else { return Ok(own) };
    let gain = equations.normal().count as f64 * (own.1.score / best.score).ln();
    let found = trials.into_iter().find(|&(lambda, _)| lambda == best.lambda);
    Ok(found.filter(|_| own.1.score > 0.0 && own.1.score.is_finite() && gain > OVERRULING).unwrap_or(own))
}

fn tensed(equations: Equations<'_>, tension: f64) -> Equations<'_> {
    if tension > 0.0 { equations.in_tension() } else { equations }
}

fn in_world(mut choice: Choice, area: f64) -> Choice {
    choice.best.lambda *= area;
    choice.least *= area;
    choice.trials.iter_mut().for_each(|trial| trial.lambda *= area);
    choice.failed.iter_mut().for_each(|trial| trial.lambda *= area);
    choice
}

/// Refuses a tension where it would have no effect, or where it is not implemented.
fn check_tension(basis: &Basis, options: &Options, are_given: bool) -> Result<()> {
    if options.tension.is_none_or(|tension| tension == 0.0) {
        return Ok(());
    }
    let is_smoothed = match options.smoothing {
        None => !are_given,
        Some(Smoothing::Lambda(lambda)) => lambda > 0.0,
        Some(Smoothing::Likelihood) => true,
        Some(Smoothing::Generalised | Smoothing::Folds(_)) => false,
    };
    let what = if !is_smoothed {
        "--tension is for splines with --lambda reml or a lambda above zero"
    } else if options.loss.is_some() {
        "--tension is not for robust fits: leave out --robust, or --tension"
    } else if basis.degree() == 0 {
        "splines of degree 0 have no gradients, and so no tension: leave out --tension"
    } else {
        return Ok(());
    };
    Err(Error::usage(what))
}

//! The choice of the smoothing parameter.

use super::layout::Layout;
use super::options::{Options, Smoothing};
use super::points::PointsInFrame;
use crate::bases::Basis;
use crate::fitting::{
    self, Choice, Equations, Method, NormalEquations, RobustStart, Solution, Symmetric, Tense,
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
        let equations = if self.chosen.tension > 0.0 { equations.in_tension() } else { equations };
        equations.solution(self.lambda)
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
    let normal = NormalEquations::of(basis, all, threads)?;
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
    let (energy, lambda, tension, choice) = match (bending, method, options.smoothing) {
        (Some(bending), Some(Method::Likelihood), _) if options.loss.is_none() => {
            let tensions: &[f64] = match options.tension {
                Some(own) => &[own],
                None if basis.degree() > 1 => &fitting::TENSIONS,
                None => &[0.0],
            };
            let Tense { energy, tension, choice } =
                fitting::choose_tension(basis, &normal, bending, tensions)?;
            (Some(energy), choice.best.lambda, tension, Some(choice))
        }
        (Some(bending), Some(method), _) => {
            let choice = if options.loss.is_some() {
                let (choice, robust) =
                    fitting::choose_robustly(&normal, basis, all, &bending, method, threads)?;
                start = Some(robust);
                choice
            } else {
                fitting::choose(&normal, basis, all, &bending, method, threads)?
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
    let chosen = SmoothingChoice { lambda: lambda * area, tension, undetermined, is_solved: true, choice };
    Ok(Problem { normal, energy, lambda, chosen, start })
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

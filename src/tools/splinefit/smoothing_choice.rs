//! The choice of the smoothing parameter.

use super::layout::Layout;
use super::options::{Options, Smoothing};
use super::points::PointsInFrame;
use spmesh_core::error::Result;
use spmesh_splines::bases::Basis;
use spmesh_splines::fitting::{
    self, Choice, Equations, Method, NormalEquations, RobustStart, Solution, Symmetric,
};

/// The smoothing of a fit, and the reason for it.
#[derive(Debug, Clone, PartialEq)]
pub struct SmoothingChoice {
    /// The factor of the thin-plate energy, in world coordinates.
    pub lambda: f64,
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
        Equations::new(basis, &self.normal, self.energy.as_ref())?.solution(self.lambda)
    }
}

/// Sets up the equations of points, and chooses `lambda`. Without an option, given knots are not smoothed: if
/// points do not determine all functions, the energy counts only for the others. Other knots are smoothed by
/// restricted maximum likelihood.
///
/// In stored coordinates, second derivatives are those of the world times the step squared, and areas are
/// those of the world divided by the step squared. So the energy is that of the world times the step squared,
/// and `lambda` is divided by the step squared.
///
/// # Errors
/// Those of [`NormalEquations::of`], [`fitting::bending`] and [`Equations::solve`].
pub(super) fn choose_smoothing(
    layout: &Layout,
    all: &PointsInFrame,
    options: &Options,
    are_given: bool,
) -> Result<Problem> {
    let (basis, threads) = (&layout.basis, options.threads);
    let normal = NormalEquations::of(basis, all, threads)?;
    let (mut undetermined, mut choice, mut start) = (None, None, None);
    if options.smoothing.is_none() && are_given {
        undetermined = Some(Equations::new(basis, &normal, None)?.undetermined(0.0)?.len());
    }
    // Robust weights may leave further functions undetermined.
    let is_determined = undetermined == Some(0) && options.loss.is_none();
    let needs_none = options.smoothing == Some(Smoothing::Lambda(0.0)) || is_determined;
    let energy = if needs_none { None } else { Some(fitting::bending(basis)?) };
    let area = layout.frame.step().powi(2);
    let method = match options.smoothing {
        Some(Smoothing::Lambda(_)) => None,
        // Least squares, with the least energy where points determine nothing.
        None if are_given => None,
        None | Some(Smoothing::Likelihood) => Some(Method::Likelihood),
        Some(Smoothing::Generalised) => Some(Method::Generalised),
        Some(Smoothing::Folds(count)) => Some(Method::Folds { count, seed: options.seed }),
    };
    let lambda = match (&energy, method, options.smoothing) {
        (Some(energy), Some(method), _) => {
            let found = if options.loss.is_some() {
                let (found, robust) = fitting::choose_robustly(&normal, basis, all, energy, method, threads)?;
                start = Some(robust);
                found
            } else {
                fitting::choose(&normal, basis, all, energy, method, threads)?
            };
            choice.insert(found).best.lambda
        }
        (Some(_), _, Some(Smoothing::Lambda(lambda))) => lambda / area,
        _ => 0.0,
    };
    if let Some(choice) = &mut choice {
        choice.best.lambda *= area;
        choice.least *= area;
        choice.trials.iter_mut().for_each(|trial| trial.lambda *= area);
        choice.failed.iter_mut().for_each(|trial| trial.lambda *= area);
    }
    let chosen = SmoothingChoice { lambda: lambda * area, undetermined, is_solved: true, choice };
    Ok(Problem { normal, energy, lambda, chosen, start })
}

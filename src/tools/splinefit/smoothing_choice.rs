//! The choice of the smoothing parameter.

use super::layout::Layout;
use super::options::{Options, Smoothing};
use super::points::PointsInFrame;
use spmesh_core::error::Result;
use spmesh_splines::bases::Basis;
use spmesh_splines::fitting::{self, Choice, Equations, Folds, NormalEquations, Symmetric};

/// The smoothing of a fit, and the reason for it.
#[derive(Debug, Clone, PartialEq)]
pub struct SmoothingChoice {
    /// The factor of the thin-plate energy, in world coordinates.
    pub lambda: f64,
    /// Number of functions that points leave undetermined without smoothing; `None` if it was not needed.
    pub undetermined: Option<usize>,
    /// The trials of cross-validation; `lambda` in world coordinates.
    pub choice: Option<Choice>,
}

/// Normal equations with a chosen `lambda`.
pub(super) struct Problem {
    pub(super) normal: NormalEquations,
    pub(super) energy: Option<Symmetric>,
    /// For stored coordinates.
    pub(super) lambda: f64,
    pub(super) chosen: SmoothingChoice,
}

impl Problem {
    pub(super) fn solve(&self, basis: &Basis) -> Result<Vec<f64>> {
        Equations::new(basis, &self.normal, self.energy.as_ref())?.solve(self.lambda)
    }
}

/// Sets up the equations of points, and chooses `lambda`. Without an option, given knots are not smoothed: if
/// points do not determine all functions, the energy counts only for the others. Other knots are smoothed.
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
    let (mut undetermined, mut choice) = (None, None);
    if options.smoothing.is_none() && are_given {
        undetermined = Some(Equations::new(basis, &normal, None)?.undetermined(0.0)?.len());
    }
    let needs_none = options.smoothing == Some(Smoothing::Lambda(0.0)) || undetermined == Some(0);
    let energy = if needs_none { None } else { Some(fitting::bending(basis)?) };
    let area = layout.frame.step().powi(2);
    let lambda = match (&energy, options.smoothing) {
        (None, _) => 0.0,
        (_, Some(Smoothing::Lambda(lambda))) => lambda / area,
        (Some(energy), Some(Smoothing::Folds(folds))) => {
            let folds = Folds::of(basis, all, folds, options.seed, threads)?;
            choice.insert(folds.choose(basis, energy)?).best.lambda
        }
        (energy, Some(Smoothing::Generalised)) => {
            let equations = Equations::new(basis, &normal, energy.as_ref())?;
            choice.insert(fitting::generalised_cross_validation(&equations, options.seed)?).best.lambda
        }
        // Least squares, with the least energy where points determine nothing.
        (_, None) if are_given => 0.0,
        (_, None) => normal.default_lambda(basis),
    };
    if let Some(choice) = &mut choice {
        choice.best.lambda *= area;
        choice.trials.iter_mut().for_each(|trial| trial.lambda *= area);
    }
    let chosen = SmoothingChoice { lambda: lambda * area, undetermined, choice };
    Ok(Problem { normal, energy, lambda, chosen })
}

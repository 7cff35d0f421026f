//! How splines are fitted.

use std::num::NonZeroUsize;
use std::str::FromStr;

use super::anisotropy::Anisotropy;
use crate::fitting::Loss;
use spmesh_formats::source::Polyline;

/// Options of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// How to smooth. If `None`, other knots than given ones are smoothed by restricted maximum likelihood.
    /// Over given knots, only the functions that points do not determine are smoothed.
    pub smoothing: Option<Smoothing>,
    /// The tension, in units of one over the distance of points. If `None`, restricted maximum likelihood
    /// chooses it together with the smoothing, unless the fit is robust; otherwise it is zero.
    pub tension: Option<f64>,
    /// The loss function of a robust fit; `None` for least squares.
    pub loss: Option<Loss>,
    /// Whether the spline interpolates the triangulated points at Greville sites.
    pub interpolates: bool,
    /// Greatest residual that needs no further knot, in a search for knots. Units: those of elevations.
    pub tolerance: Option<f64>,
    /// Greatest number of places of knots, in a search for knots.
    pub max_knots: Option<usize>,
    /// Side of the cells of a grid of knots, which replaces the search. Units: those of the world.
    pub step: Option<f64>,
    /// How values vary with directions, unless knots are given. If `None`, alike, or as the sides of the box
    /// of the points if these are very different.
    pub anisotropy: Option<Anisotropy>,
    /// How far the domain reaches beyond the hull of the points, for knots that follow from their density; by
    /// default half their typical distance. Units: those of the world.
    pub widen: Option<f64>,
    /// Polylines along which splines are not smooth; for knots without configurations.
    pub polylines: Vec<Polyline>,
    /// The name of their file in messages.
    pub polylines_name: String,
    /// Degree of splines, for knots with configurations of several degrees.
    pub degree: Option<usize>,
    /// The typical distance of points, if it is known; otherwise the root of the area of a point.
    pub distance: Option<f64>,
    /// Whether the errors of the spline are wanted.
    pub wants_errors: bool,
    /// Seed of folds.
    pub seed: u64,
    /// Threads that evaluate functions.
    pub threads: NonZeroUsize,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            smoothing: None,
            tension: None,
            loss: None,
            interpolates: false,
            tolerance: None,
            max_knots: None,
            step: None,
            anisotropy: None,
            widen: None,
            polylines: Vec::new(),
            polylines_name: String::new(),
            degree: None,
            distance: None,
            wants_errors: false,
            seed: 1,
            threads: NonZeroUsize::MIN,
        }
    }
}

/// How much to smooth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Smoothing {
    /// By this factor of the thin-plate energy. Units: an area, if weights have none.
    Lambda(f64),
    /// By restricted maximum likelihood.
    Likelihood,
    /// By generalised cross-validation.
    Generalised,
    /// By cross-validation with this number of folds.
    Folds(usize),
}

const FOLDS: usize = 5;

/// Folds at most: each of them takes the time and memory of a fit.
const FOLDS_MAX: usize = 100;

impl FromStr for Smoothing {
    type Err = String;

    fn from_str(text: &str) -> Result<Smoothing, String> {
        match text.split_once(':') {
            Some(("cv", folds)) => match folds.parse() {
                Ok(folds) if (2..=FOLDS_MAX).contains(&folds) => Ok(Smoothing::Folds(folds)),
                _ => Err(format!("{folds:?} folds: expected an integer from 2 to {FOLDS_MAX}")),
            },
            _ if text == "cv" => Ok(Smoothing::Folds(FOLDS)),
            _ if text == "reml" => Ok(Smoothing::Likelihood),
            _ if text == "gcv" => Ok(Smoothing::Generalised),
            _ => match text.parse() {
                Ok(lambda) if (0.0..f64::INFINITY).contains(&lambda) => Ok(Smoothing::Lambda(lambda)),
                _ => Err("expected a number that is not negative, reml, gcv, cv or cv:FOLDS".into()),
            },
        }
    }
}

//! Cross-validation: how well a fit predicts points that it has not seen.

use std::io::Write;
use std::str::FromStr;

use super::fit::{Fitted, fit};
use super::frame::Frame;
use super::options::Options;
use super::points::Points;
use super::table;
use crate::bases::Scratch;
use crate::fitting;
use spmesh_base::error::{Error, Result};
use spmesh_base::random::Random;
use spmesh_delaunay::predicates::Point2;

/// What is left out at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Validation {
    /// One of so many random parts of the places.
    Folds(usize),
    /// One of ten random parts of the squares of a grid, whose side is given; by default, an eighth of the
    /// longer side of the box of points. Units: those of the world.
    Blocks(Option<f64>),
    /// One place, without another choice of knots and smoothing.
    One,
}

/// Folds of blocks, and of points by default.
const FOLDS: usize = 10;
/// Folds at most: each takes a fit.
const FOLDS_MAX: usize = 100;
/// Squares along the longer side of the box of points.
const SQUARES: f64 = 8.0;

impl FromStr for Validation {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Validation, String> {
        let positive = |side: &str| side.parse().ok().filter(|&side: &f64| side > 0.0 && side.is_finite());
        match (text, text.split_once(':')) {
            ("one", _) => Ok(Validation::One),
            ("blocks", _) => Ok(Validation::Blocks(None)),
            (_, Some(("blocks", side))) => match positive(side) {
                Some(side) => Ok(Validation::Blocks(Some(side))),
                None => Err(format!("blocks of side {side:?}: expected a number above zero")),
            },
            _ => match text.parse() {
                Ok(folds) if (2..=FOLDS_MAX).contains(&folds) => Ok(Validation::Folds(folds)),
                _ => Err(format!("expected 2 to {FOLDS_MAX} folds, blocks, blocks:SIDE or one")),
            },
        }
    }
}

/// A point and what the others predict there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// The place, in world coordinates.
    pub place: Point2,
    /// The value of the point.
    pub value: f64,
    /// The prediction.
    pub predicted: f64,
    /// The standard deviation of the point from it.
    pub error: f64,
    /// Half the width of the interval of 95 %.
    pub half: f64,
}

/// The outcome of cross-validation.
#[derive(Debug, Clone, PartialEq)]
pub struct Validated {
    /// The predicted points, in their order.
    pub predictions: Vec<Prediction>,
    /// Number of points outside of the domain that the others have.
    pub outside: u64,
}

impl Validated {
    /// The mean of the errors: value less prediction.
    pub fn mean(&self) -> f64 {
        self.sum(|one| one.value - one.predicted)
    }

    /// The root of their mean square.
    pub fn root_mean_square(&self) -> f64 {
        self.sum(|one| (one.value - one.predicted).powi(2)).sqrt()
    }

    /// The part of the points that their intervals hold.
    pub fn held(&self) -> f64 {
        self.sum(|one| f64::from((one.value - one.predicted).abs() <= one.half))
    }

    fn sum(&self, of: impl Fn(&Prediction) -> f64) -> f64 {
        self.predictions.iter().map(of).sum::<f64>() / self.predictions.len() as f64
    }

    /// Writes the predictions as a table.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, output: &mut impl Write) -> Result<u64> {
        let columns = ["x", "y", "z", "predicted", "prediction_error", "lower", "upper"];
        table::write_title(output, columns.iter())?;
        for &Prediction { place: [x, y], value, predicted, error, half } in &self.predictions {
            let [lower, upper] = [predicted - half, predicted + half];
            writeln!(output, "{x} {y} {value} {predicted} {error} {lower} {upper}")
                .map_err(table::write_error)?;
        }
        Ok(self.predictions.len() as u64)
    }
}

/// Cross-validates a fit. `options` are those of the fit, and ask for errors.
///
/// Points at one place are left out together. Cost: a fit for each fold; for [`Validation::One`], a pass.
///
/// # Errors
/// Points too many to be held in memory; those of fits.
pub fn validate(
    fitted: &Fitted,
    points: &Points,
    validation: Validation,
    options: &Options,
    done: &dyn Fn(u64),
) -> Result<Validated> {
    let side = match validation {
        Validation::One => return one_by_one(fitted, points, options),
        Validation::Folds(_) => None,
        Validation::Blocks(Some(side)) => Some(side),
        Validation::Blocks(None) => {
            let [low, high] = fitting::bounds(&points.in_frame(&Frame::world(points.crs().clone()), done))?;
            Some((high[0] - low[0]).max(high[1] - low[1]) / SQUARES)
        }
    };
    let folds = if let Validation::Folds(folds) = validation { folds } else { FOLDS };
    let fold_of = |place: Point2| {
        let key = place.map(|x| side.map_or(x + 0.0, |side| (x / side).floor()).to_bits());
        let seed = options.seed ^ key[0].wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ key[1].rotate_left(32);
        Random::new(seed).below(folds as u64) as usize
    };
    let (mut found, mut outside) = (Vec::new(), 0);
    for fold in 0..folds {
        let rest = points.only(|place| fold_of(place) != fold)?;
        if rest.count() == points.count() {
            continue;
        }
        let fitted = fit(&rest, None, options, &|_| ())?;
        let mut scratch = Scratch::default();
        points.for_each(|index, one| {
            if fold_of(one.point) == fold {
                match fitted.prediction(one, &mut scratch) {
                    Some(prediction) => found.push((index, prediction)),
                    None => outside += 1,
                }
            }
        })?;
        done(found.len() as u64);
    }
    found.sort_by_key(|&(index, _)| index);
    finished(found.into_iter().map(|(_, prediction)| prediction).collect(), outside)
}

fn one_by_one(fitted: &Fitted, points: &Points, options: &Options) -> Result<Validated> {
    let (layout, coefficients, certainty) = fitted.errors()?;
    let all = points.sites_in_frame(&layout.frame, &|_| ());
    let mut predictions = Vec::new();
    let outside = certainty.for_each_left_out(
        &layout.basis,
        coefficients,
        &all,
        options.threads,
        |found, residual, error| {
            let [x, y] = layout.frame.to_world(found.point);
            let (value, half) = (found.value, certainty.width * error);
            predictions.push(Prediction { place: [x, y], value, predicted: value - residual, error, half });
        },
    )?;
    finished(predictions, outside)
}

fn finished(predictions: Vec<Prediction>, outside: u64) -> Result<Validated> {
    match predictions.is_empty() {
        true => Err(Error::usage(
            "cross-validation predicts no point: all are outside of the domain of the others",
        )),
        false => Ok(Validated { predictions, outside }),
    }
}

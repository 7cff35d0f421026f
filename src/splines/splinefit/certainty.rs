//! How sure a spline is: standard errors of its values, of predictions, and intervals that hold 95 % of them.
//!
//! Intervals have the width that held 95 % of the points when each was left out: errors of ground between
//! sparse points are not normal, and what a smooth spline cannot follow is not all noise. Leaving a point out
//! needs no other fit: if h is its leverage, its residual becomes that of the fit divided by 1 - h, and the
//! variance of the prediction, in units of that of the point, 1 / (1 - h) (Cook and Weisberg 1982). Knots and
//! smoothing are those of all points.

use std::num::NonZeroUsize;

use super::layout::{Layout, Spline};
use super::points::{Points, PointsInFrame};
use crate::bases::{Basis, Scratch};
use crate::fitting::{self, Covariance, Equations, NormalEquations, Quality, Recovered, Residual};
use spmesh_base::error::{Error, Result};

/// What the points of a spline tell about its errors.
#[derive(Debug)]
pub struct Certainty {
    covariance: Covariance,
    /// The standard deviation of a point of weight one: of the residuals, corrected for the effective number
    /// of parameters. Units: those of elevations.
    pub noise: f64,
    /// Half the width of intervals, in prediction errors: 1.96 if these are normal.
    pub width: f64,
}

/// The part of points that intervals hold.
const HELD: f64 = 0.95;
/// Half the width of that part of a normal distribution, in standard deviations.
const NORMAL: f64 = 1.96;
/// With fewer points, the width is that of normal errors.
const POINTS_MIN: usize = 40;

impl Certainty {
    /// The certainty of a spline that was fitted to some points. Its smoothing follows from its coefficients.
    ///
    /// Cost: a pass over the points, two factorisations and two selected inverses. Memory: that of a fit over
    /// the same knots.
    ///
    /// # Errors
    /// Usage, if the spline is not a fit to these points; those of reading.
    pub fn of(spline: &Spline, points: &Points, threads: NonZeroUsize) -> Result<(Certainty, Recovered)> {
        let Layout { basis, frame, .. } = &spline.layout;
        let all = points.in_frame(frame, &|_| ());
        let normal = NormalEquations::of(basis, &all, threads)?;
        let (bending, membrane) = (fitting::bending(basis)?, fitting::membrane(basis)?);
        let plain = Equations::new(basis, &normal, Some(&bending))?;
        let energies = [&bending, &membrane];
        let smoothing = fitting::recovered(basis, &plain, energies, &spline.coefficients)
            .map_err(|error| error.of_input(points.name()))?;
        let Recovered { lambda, of_membrane } = smoothing;
        let energy = bending.plus(of_membrane / lambda, &membrane);
        let equations = Equations::new(basis, &normal, Some(&energy))?;
        let equations = if of_membrane > 0.0 { equations.in_tension() } else { equations };
        let certainty = Certainty::new(&equations, lambda).map_err(|error| error.of_input(points.name()))?;
        Ok((certainty.calibrated(basis, &spline.coefficients, &all, threads)?, smoothing))
    }

    /// The certainty of the solution of some equations, with intervals of normal errors.
    ///
    /// # Errors
    /// As many effective parameters as points.
    pub(super) fn new(equations: &Equations, lambda: f64) -> Result<Certainty> {
        let Quality { noise, .. } = Quality::of(equations, lambda)?;
        if !noise.is_finite() {
            let what = "there are as many effective parameters as points, which leaves nothing to tell the noise \
                        from: smooth more";
            return Err(Error::usage(what));
        }
        Ok(Certainty { covariance: Covariance::of(equations, lambda)?, noise, width: NORMAL })
    }

    /// The same with intervals that hold the points, each left out.
    pub(super) fn calibrated(
        self,
        basis: &Basis,
        coefficients: &[f64],
        all: &PointsInFrame,
        threads: NonZeroUsize,
    ) -> Result<Certainty> {
        let mut sizes = Vec::new();
        self.for_each_left_out(basis, coefficients, all, threads, |_, error, deviation| {
            sizes.push(error.abs() / deviation);
        })?;
        if sizes.len() < POINTS_MIN {
            return Ok(self);
        }
        let place = ((HELD * (sizes.len() + 1) as f64).ceil() as usize).min(sizes.len()) - 1;
        let (_, &mut width, _) = sizes.select_nth_unstable_by(place, f64::total_cmp);
        Ok(Certainty { width: if width > 0.0 { width } else { NORMAL }, ..self })
    }

    /// Calls `visit` with the residuals of all points in the domain, what they are if the point is left out,
    /// and the prediction error then.
    ///
    /// # Errors
    /// Those of reading.
    pub(super) fn for_each_left_out(
        &self,
        basis: &Basis,
        coefficients: &[f64],
        all: &PointsInFrame,
        threads: NonZeroUsize,
        mut visit: impl FnMut(&Residual, f64, f64),
    ) -> Result<u64> {
        let mut scratch = Scratch::default();
        fitting::for_each_residual(basis, coefficients, all, threads, |found| {
            let rest = 1.0 - found.weight * self.covariance.variance(basis.at(found.point, &mut scratch));
            if found.weight > 0.0 && rest > 0.0 {
                visit(&found, found.residual / rest, self.noise / (found.weight * rest).sqrt());
            }
        })
    }

    /// The standard error of the sum of functions with these values.
    pub(super) fn standard_error(&self, values: &[(u32, f64)]) -> f64 {
        self.noise * self.covariance.variance(values).sqrt()
    }
}

//! How sure a spline is: standard errors of its values, and of predictions.

use std::num::NonZeroUsize;

use super::layout::{Layout, Spline};
use super::points::Points;
use crate::fitting::{self, Covariance, Equations, NormalEquations, Quality, Recovered};
use spmesh_base::error::{Error, Result};

/// What the points of a spline tell about its errors.
#[derive(Debug)]
pub struct Certainty {
    covariance: Covariance,
    /// The standard deviation of a point of weight one: of the residuals, corrected for the effective number
    /// of parameters. Units: those of elevations.
    pub noise: f64,
    /// The smoothing that the spline was fitted with, in the coordinates of its knots.
    pub smoothing: Recovered,
}

impl Certainty {
    /// The certainty of a spline that was fitted to some points. Its smoothing follows from its coefficients.
    ///
    /// Cost: a pass over the points, two factorisations and two selected inverses. Memory: that of a fit over
    /// the same knots.
    ///
    /// # Errors
    /// Usage, if the spline is not a fit to these points; those of reading.
    pub fn of(spline: &Spline, points: &Points, threads: NonZeroUsize) -> Result<Certainty> {
        let Layout { basis, frame, .. } = &spline.layout;
        let normal = NormalEquations::of(basis, &points.in_frame(frame, &|_| ()), threads)?;
        let (bending, membrane) = (fitting::bending(basis)?, fitting::membrane(basis)?);
        let plain = Equations::new(basis, &normal, Some(&bending))?;
        let energies = [&bending, &membrane];
        let smoothing = fitting::recovered(basis, &plain, energies, &spline.coefficients)
            .map_err(|error| error.of_input(points.name()))?;
        let Recovered { lambda, of_membrane } = smoothing;
        let energy = bending.plus(of_membrane / lambda, &membrane);
        let equations = Equations::new(basis, &normal, Some(&energy))?;
        let equations = if of_membrane > 0.0 { equations.in_tension() } else { equations };
        let Quality { noise, .. } = Quality::of(&equations, lambda)?;
        if !noise.is_finite() {
            let what = "there are as many effective parameters as points, which leaves nothing to tell the noise \
                        from: smooth more";
            return Err(Error::usage(what).of_input(points.name()));
        }
        Ok(Certainty { covariance: Covariance::of(&equations, lambda)?, noise, smoothing })
    }

    /// The standard error of the sum of functions with these values.
    pub(super) fn standard_error(&self, values: &[(u32, f64)]) -> f64 {
        self.noise * self.covariance.variance(values).sqrt()
    }
}

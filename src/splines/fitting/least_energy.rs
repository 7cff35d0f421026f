//! Least squares that leave functions undetermined: of all solutions, the one with the least energy.
//!
//! Let N be the matrix of the normal equations, and E that of the energy. Conjugate gradients for N c = b,
//! preconditioned by N + s E with a small s and started from zero, stay in the span of the vectors
//! (N + s E)^-1 N v. Where v has no observations, these vectors have no energy in common with v, because
//! v'(N + s E) (N + s E)^-1 N v' = (N v)'v' = 0. So the limit solves N c = b, and has the least energy of all
//! that do. Smoothing with s alone would also change what observations determine.
//!
//! Directions that observations determine less than rounding errors matter are not pursued: they keep the
//! energy's choice.

use super::cholesky::Factor;
use super::symmetric::Symmetric;

/// The factor s, in units of [`super::Equations::unit`]: directions that observations determine at least this
/// well converge in a few steps.
pub(super) const SHARE: f64 = 1e-4;
/// The steps end when the residual is this part of the given right side, in the norm of the inverse
/// preconditioner: rounding errors of the right side must not be pursued.
const RESIDUAL: f64 = 1e-13;
/// Steps, at most: about ten are needed.
const STEPS_MAX: usize = 100;

/// The solution of `matrix` c = `right` that has the least energy. `factor` is that of the matrix plus a
/// small part of the energy. `given` is the right side before the linear trend was subtracted from it.
///
/// Source: Hestenes and Stiefel, "Methods of conjugate gradients for solving linear systems", 1952.
pub(super) fn solve(matrix: &Symmetric, factor: &Factor, right: &[f64], given: &[f64]) -> Vec<f64> {
    let mut solution = vec![0.0; right.len()];
    let mut residual = right.to_vec();
    let mut step = factor.solve_once(&residual);
    let mut direction = step.clone();
    let mut size = dot(&residual, &step);
    let goal = RESIDUAL * RESIDUAL * dot(given, &factor.solve_once(given));
    for _ in 0..STEPS_MAX {
        let product = matrix.times(&direction);
        let curvature = dot(&direction, &product);
        if size <= goal || curvature <= 0.0 {
            break;
        }
        let length = size / curvature;
        add(&mut solution, length, &direction);
        add(&mut residual, -length, &product);
        step = factor.solve_once(&residual);
        let next = dot(&residual, &step);
        let kept = next / size;
        direction.iter_mut().zip(&step).for_each(|(along, step)| *along = step + kept * *along);
        size = next;
    }
    solution
}

fn add(sum: &mut [f64], factor: f64, other: &[f64]) {
    sum.iter_mut().zip(other).for_each(|(sum, other)| *sum += factor * other);
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

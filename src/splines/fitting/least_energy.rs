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

use super::cholesky::{CURVATURE_MIN, Factor};
use super::solve::Solution;
use super::symmetric::Symmetric;

/// The factor s, in units of [`super::Equations::unit`]: directions that observations determine at least this
/// well converge in a few steps.
pub(super) const SHARE: f64 = 1e-4;
/// The steps end when each residual is this part of what its right side can be at most. Rounding errors of
/// the right side are less; where observations determine nothing, steps that pursue them are far too long.
const RESIDUAL: f64 = 1e-13;
/// Steps, at most: about ten are needed.
const STEPS_MAX: usize = 100;

/// The solution of `matrix` c = `right` that has the least energy. `factor` is that of the matrix plus a
/// small part of the energy. `size` is the root of the weighted sum of squares of the values: with a diagonal
/// entry d of the matrix, a right side is at most `size` times the root of d (Cauchy and Schwarz).
///
/// Source: Hestenes and Stiefel, "Methods of conjugate gradients for solving linear systems", 1952.
pub(super) fn solve(matrix: &Symmetric, factor: &Factor, right: &[f64], size: f64) -> Solution {
    let diagonal: Vec<f64> = matrix.diagonal().collect();
    let is_rounding = |residual: &[f64]| {
        let mut both = residual.iter().zip(&diagonal);
        both.all(|(residual, entry)| residual.abs() <= RESIDUAL * size * entry.sqrt())
    };
    let mut coefficients = vec![0.0; right.len()];
    let mut residual = right.to_vec();
    let mut direction = factor.solve_once(&residual);
    let mut product = dot(&residual, &direction);
    for _ in 0..STEPS_MAX {
        if is_rounding(&residual) {
            return Solution { coefficients, has_converged: true };
        }
        let image = matrix.times(&direction);
        let curvature = dot(&direction, &image);
        let alone: f64 = diagonal.iter().zip(&direction).map(|(entry, along)| entry * along * along).sum();
        if curvature <= CURVATURE_MIN * alone {
            break;
        }
        let length = product / curvature;
        add(&mut coefficients, length, &direction);
        add(&mut residual, -length, &image);
        let step = factor.solve_once(&residual);
        let next = dot(&residual, &step);
        let kept = next / product;
        direction.iter_mut().zip(&step).for_each(|(along, step)| *along = step + kept * *along);
        product = next;
    }
    Solution { has_converged: is_rounding(&residual), coefficients }
}

fn add(sum: &mut [f64], factor: f64, other: &[f64]) {
    sum.iter_mut().zip(other).for_each(|(sum, other)| *sum += factor * other);
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fitting::cholesky::Elimination;
    use crate::fitting::normal_equations::Rows;

    const COUNT: usize = 400;

    /// A matrix with `beside` next to its diagonal.
    fn chain(diagonal: f64, beside: f64) -> Symmetric {
        let mut rows = Rows::new(COUNT, 1);
        for row in 0..COUNT {
            let next = [(row as u32, diagonal), (row as u32 + 1, beside)];
            rows.add(row, 0, 1.0, if row + 1 < COUNT { &next } else { &next[..1] });
        }
        Symmetric::of_rows(&rows, |_| true)
    }

    #[test]
    fn too_many_steps_are_told() {
        // The value at one end reaches the other end after as many steps as there are rows.
        let (matrix, far) = (chain(2.0, -1.0), chain(1.0, 0.0));
        let elimination = Elimination::of(&matrix).expect("a pattern");
        let mut right = vec![0.0; COUNT];
        right[0] = 1.0;
        for (preconditioner, has_converged) in [(&matrix, true), (&far, false)] {
            let factor = elimination.factor(preconditioner).expect("a factor");
            let found = solve(&matrix, &factor, &right, 1.0);
            assert_eq!(found.has_converged, has_converged);
            assert!(found.coefficients.iter().all(|c| c.is_finite()));
        }
    }

    #[test]
    fn rounding_errors_are_not_pursued() {
        // One of three functions has observations. The right side of another one is a rounding error.
        let with = |entry: f64| {
            let mut rows = Rows::new(3, 1);
            rows.add(0, 0, 1.0, &[(0, 1.0), (1, 1e-9)]);
            rows.add(1, 0, 1.0, &[(1, 1e-18 + entry)]);
            rows.add(2, 0, 1.0, &[(2, entry)]);
            Symmetric::of_rows(&rows, |_| true)
        };
        let (matrix, regular) = (with(0.0), with(1e-8));
        let elimination = Elimination::of(&matrix).expect("a pattern");
        let factor = elimination.factor(&regular).expect("a factor");
        let found = solve(&matrix, &factor, &[5.0, 5e-9 + 1e-24, 0.0], 5.0);
        assert!(found.has_converged);
        for (c, expected) in found.coefficients.iter().zip([5.0, 0.0, 0.0]) {
            assert!((c - expected).abs() < 1e-6, "{:?}", found.coefficients);
        }
    }
}

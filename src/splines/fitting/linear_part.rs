//! Energies without the part that linear functions have.
//!
//! The membrane energy of a plane depends on its slope, but a slope says nothing about how rough a surface
//! is. So the energy of a spline is the least one after subtraction of a linear function. If the columns of X
//! are the slopes x and y, and S = X'EX, its matrix is E - EX S^-1 X'E. That matrix is full, but it differs
//! from E by rank 2: solutions and determinants follow from those with E (Sherman, Morrison and Woodbury).

use super::cholesky::Factor;
use super::symmetric::Symmetric;
use super::trend::linear_functions;
use crate::bases::Basis;

/// The part of an energy that linear functions have.
#[derive(Debug)]
pub(super) struct LinearPart {
    /// The columns of EX.
    products: [Vec<f64>; 2],
    /// X'EX.
    gram: [[f64; 2]; 2],
}

/// A linear part together with factored equations F = N + lambda E.
pub(super) struct Correction<'a> {
    part: &'a LinearPart,
    lambda: f64,
    /// The columns of F^-1 EX.
    solved: [Vec<f64>; 2],
    /// S - lambda X'E F^-1 EX.
    rest: [[f64; 2]; 2],
}

impl LinearPart {
    pub(super) fn of(basis: &Basis, energy: &Symmetric) -> LinearPart {
        let [_, slopes @ ..] = linear_functions(basis);
        let products = slopes.each_ref().map(|slope| energy.times(slope));
        let gram = slopes.each_ref().map(|slope| products.each_ref().map(|product| dot(slope, product)));
        LinearPart { products, gram }
    }

    pub(super) fn correction(&self, factor: &Factor, lambda: f64) -> Correction<'_> {
        let solved = self.products.each_ref().map(|product| factor.solve(product));
        let rest =
            [0, 1].map(|i| [0, 1].map(|j| self.gram[i][j] - lambda * dot(&self.products[i], &solved[j])));
        Correction { part: self, lambda, solved, rest }
    }
}

impl Correction<'_> {
    /// Turns a solution with F into that of the equations without the linear part.
    pub(super) fn apply(&self, solution: &mut [f64]) {
        let [[a, b], [c, d]] = self.rest;
        let [p, q] = self.part.products.each_ref().map(|product| self.lambda * dot(product, solution));
        let determinant = a * d - b * c;
        let shares = [(d * p - b * q) / determinant, (a * q - c * p) / determinant];
        for (share, column) in shares.into_iter().zip(&self.solved) {
            solution.iter_mut().zip(column).for_each(|(x, step)| *x += share * step);
        }
    }

    /// The logarithm of the determinant of the equations without the linear part, less that of F, plus that
    /// of S.
    pub(super) fn log_determinant(&self) -> f64 {
        let [[a, b], [c, d]] = self.rest;
        (a * d - b * c).ln()
    }
}

/// Three functions at sites that span a large triangle, and the logarithm of the determinant of the values of
/// linear functions there.
pub(super) fn corners(basis: &Basis) -> (Vec<usize>, f64) {
    let [_, x, y] = linear_functions(basis);
    let greatest = |size: &dyn Fn(usize) -> f64| {
        (0..basis.len()).max_by(|&a, &b| size(a).total_cmp(&size(b))).unwrap_or(0)
    };
    let a = greatest(&|at| -x[at] - y[at]);
    let b = greatest(&|at| (x[at] - x[a]).hypot(y[at] - y[a]));
    let area = |at: usize| ((x[b] - x[a]) * (y[at] - y[a]) - (y[b] - y[a]) * (x[at] - x[a])).abs();
    let c = greatest(&area);
    (vec![a, b, c], area(c).ln())
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

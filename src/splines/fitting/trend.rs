//! The least-squares linear function.
//!
//! Linear functions do not bend, so the smoothest splines are close to a linear function. With a great
//! `lambda`, the rounding errors of its bending energy would outweigh all observations. So the linear part is
//! computed on its own, and the equations are solved for the difference.

use super::normal_equations::NormalEquations;
use crate::bases::Basis;

/// Pivots below this part of the diagonal are treated as zero: observations on a line determine no slope
/// across it.
const PIVOT_MIN: f64 = 1e-9;
/// Pivots below this part of the weight of all observations are rounding errors: observations are on a line.
const PIVOT_ROUNDING: f64 = 1e-13;

/// The least-squares linear function.
#[derive(Debug)]
pub(super) struct Trend {
    pub(super) coefficients: Vec<f64>,
    /// Whether observations are not all on one line, except for rounding errors. No energy depends on linear
    /// functions, so with an energy, this decides whether all functions are determined.
    pub(super) is_determined: bool,
}

/// The least-squares linear function. A linear function has its own values at Greville sites as coefficients.
pub(super) fn trend(basis: &Basis, normal: &NormalEquations) -> Trend {
    let columns = linear_functions(basis);
    let products: Vec<Vec<f64>> = columns.iter().map(|column| normal.matrix.times(column)).collect();
    let mut rows = [[0.0; 4]; 3];
    for (row, column) in rows.iter_mut().zip(&columns) {
        (0..3).for_each(|i| row[i] = dot(column, &products[i]));
        row[3] = dot(column, &normal.right);
    }
    let (factors, pivot) = solve(rows);
    let at = |function: usize| (0..3).map(|k| factors[k] * columns[k][function]).sum();
    Trend { coefficients: (0..basis.len()).map(at).collect(), is_determined: pivot > PIVOT_ROUNDING }
}

/// The functions 1, x and y at Greville sites, centred and scaled to their extent.
pub(super) fn linear_functions(basis: &Basis) -> [Vec<f64>; 3] {
    let of_axis = |axis: usize| {
        let all: Vec<f64> = (0..basis.len()).map(|function| basis.greville(function)[axis]).collect();
        let [min, max] =
            all.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[min, max], &x| [min.min(x), max.max(x)]);
        let (middle, half) = (min.midpoint(max), (0.5 * (max - min)).max(f64::MIN_POSITIVE));
        all.into_iter().map(|x| (x - middle) / half).collect()
    };
    [vec![1.0; basis.len()], of_axis(0), of_axis(1)]
}

/// Solves three equations with a positive semidefinite matrix; undetermined unknowns are zero. Also returns
/// the least pivot, relative to the first entry.
fn solve(mut rows: [[f64; 4]; 3]) -> ([f64; 3], f64) {
    let diagonal = [0, 1, 2].map(|i| rows[i][i]);
    let mut is_known = [false; 3];
    let mut least = f64::INFINITY;
    for i in 0..3 {
        least = least.min(rows[i][i] / diagonal[0].max(f64::MIN_POSITIVE));
        if rows[i][i] <= PIVOT_MIN * diagonal[i] {
            continue;
        }
        is_known[i] = true;
        let pivot = rows[i];
        for row in rows.iter_mut().skip(i + 1) {
            let factor = row[i] / pivot[i];
            row.iter_mut().zip(pivot).for_each(|(entry, above)| *entry -= factor * above);
        }
    }
    let mut solution = [0.0; 3];
    for i in (0..3).rev().filter(|&i| is_known[i]) {
        let known: f64 = (i + 1..3).map(|k| rows[i][k] * solution[k]).sum();
        solution[i] = (rows[i][3] - known) / rows[i][i];
    }
    (solution, least)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_equations_are_solved() {
        let rows = [[4.0, 2.0, 0.0, 8.0], [2.0, 5.0, 1.0, 15.0], [0.0, 1.0, 2.0, 8.0]];
        let (found, pivot) = solve(rows);
        assert!(pivot > 0.1);
        for (found, expected) in found.iter().zip([1.0, 2.0, 3.0]) {
            assert!((found - expected).abs() < 1e-14);
        }
        // The third column is the sum of the others, so that its unknown is undetermined.
        let found = solve([[4.0, 2.0, 6.0, 8.0], [2.0, 5.0, 7.0, 12.0], [6.0, 7.0, 13.0, 20.0]]);
        assert_eq!(found, ([1.0, 2.0, 0.0], 0.0));
    }
}

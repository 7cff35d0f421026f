//! Symmetric positive definite equations, solved by sparse Cholesky factors.
//!
//! Bases can be linearly dependent, and observations can leave gaps, so matrices are never factored
//! unchanged. Equations are scaled to a diagonal of ones, and [`RIDGE`] is added to it; refinement with the
//! residuals of the true equations removes the effect of the ridge, as far as the equations determine the
//! solution.
//!
//! A direction v that the equations do not determine has v'Mv near zero for the scaled matrix M. Of the
//! functions with a part in v, the one that is eliminated last has a small pivot: about v'(M + ridge)v
//! divided by the square of its part of v. That part may be small itself, so a small pivot only makes a
//! function a candidate. The solution v for a unit vector at the candidate is nearly an undetermined
//! direction, and its curvature v'Mv / v'Dv decides. The diagonal D has what observations add to that of the
//! matrix, not all of it: the energy of some functions may be so great that everything is small against it.

use super::selected_inverse::Blocks;
use super::symmetric::Symmetric;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::cholesky::{
    LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky, supernodal,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};
use spmesh_base::error::{Error, ErrorKind, Result};

/// Added to a diagonal of ones: a few hundred times the rounding error of a pivot.
pub(super) const RIDGE: f64 = 1e-13;
/// Directions v with a lesser v'Mv / v'Dv are undetermined.
pub(super) const CURVATURE_MIN: f64 = 1e-12;
/// Functions are looked at from the least pivot on. So many determined ones in a row end the search: with
/// very little smoothing, a hundred thousand of them have small pivots, and looking at one takes a solution.
const STRONG_ENOUGH: usize = 200;
/// Steps of refinement. For pivots that are not weak, each step multiplies the error by the relative error
/// that the ridge causes.
const REFINEMENTS: usize = 3;

/// The order of elimination for a sparsity pattern, and the pattern of its factors.
#[derive(Debug)]
pub(super) struct Elimination {
    symbolic: SymbolicCholesky<usize>,
    entries: usize,
}

/// Factors of a matrix.
#[derive(Debug)]
pub(super) struct Factor<'a> {
    elimination: &'a Elimination,
    matrix: &'a Symmetric,
    /// The factors that scale rows and columns.
    scale: Vec<f64>,
    values: Vec<f64>,
}

impl Elimination {
    /// Analyses the pattern of a matrix. Cost: minimum degree ordering.
    pub(super) fn of(matrix: &Symmetric) -> Result<Elimination> {
        let ordering = SymmetricOrdering::Amd;
        let symbolic =
            factorize_symbolic_cholesky(pattern(matrix), Side::Lower, ordering, Default::default());
        let symbolic = symbolic.map_err(|_| too_large(matrix.len()))?;
        Ok(Elimination { symbolic, entries: matrix.entries_len() })
    }

    /// Factors a matrix with this pattern.
    pub(super) fn factor<'a>(&'a self, matrix: &'a Symmetric) -> Result<Factor<'a>> {
        assert_eq!(self.entries, matrix.entries_len(), "a matrix of another pattern");
        let scale: Vec<f64> =
            matrix.diagonal().map(|entry| if entry > 0.0 { 1.0 / entry.sqrt() } else { 1.0 }).collect();
        let mut values = vec![0.0; self.symbolic.len_val()];
        let scratch = self.symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| too_large(matrix.len()))?;
        let scaled = matrix.scaled(&scale, RIDGE);
        let factored = self.symbolic.factorize_numeric_llt(
            &mut values,
            SparseColMatRef::new(pattern(&scaled), &scaled.values),
            Side::Lower,
            Default::default(),
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        );
        // The memory is allocated already, so that only a pivot can fail.
        match factored {
            Ok(_) => Ok(Factor { elimination: self, matrix, scale, values }),
            Err(_) => Err(Error::usage(
                "the equations are not positive definite: weights are too great for 64 bits",
            )),
        }
    }
}

impl Factor<'_> {
    /// The solution for a right side.
    pub(super) fn solve(&self, right: &[f64]) -> Vec<f64> {
        let mut solution = self.solve_once(right);
        for _ in 0..REFINEMENTS {
            let product = self.matrix.times(&solution);
            let residual: Vec<f64> = right.iter().zip(product).map(|(right, left)| right - left).collect();
            let step = self.solve_once(&residual);
            solution.iter_mut().zip(step).for_each(|(x, step)| *x += step);
        }
        solution
    }

    /// The solution of the equations with the ridge, without refinement.
    pub(super) fn solve_once(&self, right: &[f64]) -> Vec<f64> {
        let symbolic = &self.elimination.symbolic;
        let count = right.len();
        let mut x: Vec<f64> = right.iter().zip(&self.scale).map(|(right, scale)| right * scale).collect();
        let mut memory = MemBuffer::new(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        LltRef::new(symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut x, count, 1),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        x.iter_mut().zip(&self.scale).for_each(|(x, scale)| *x *= scale);
        x
    }

    /// The functions that are not determined, given those eliminated before, in order of their numbers. Each
    /// comes with the curvature v'Mv / v'Dv in its undetermined direction. D is `sizes`, or the diagonal of
    /// the matrix where that is less.
    pub(super) fn weak(&self, sizes: &[f64]) -> Vec<(usize, f64)> {
        let symbolic = &self.elimination.symbolic;
        let original = symbolic.perm().map(|order| order.arrays().0);
        // A unit vector has a part of at least 1 / sqrt(number of functions) in some function.
        let pivot_min = 10.0 * CURVATURE_MIN * self.scale.len() as f64;
        let pivots = self.pivots();
        let mut places: Vec<usize> = (0..pivots.len()).filter(|&place| pivots[place] < pivot_min).collect();
        places.sort_by(|&a, &b| pivots[a].total_cmp(&pivots[b]));
        let (mut weak, mut strong) = (Vec::new(), 0);
        for function in places.into_iter().map(|place| original.map_or(place, |order| order[place])) {
            let curvature = self.curvature(function, sizes);
            if curvature < CURVATURE_MIN {
                weak.push((function, curvature));
                strong = 0;
            } else {
                strong += 1;
            }
            if strong == STRONG_ENOUGH {
                break;
            }
        }
        weak.sort_unstable_by_key(|&(function, _)| function);
        weak
    }

    /// The factor of the scaled matrix, in blocks.
    pub(super) fn blocks(&self) -> Blocks<'_> {
        Blocks::new(&self.elimination.symbolic, &self.values)
    }

    /// The factors that scale rows and columns.
    pub(super) fn scale(&self) -> &[f64] {
        &self.scale
    }

    /// The place of a function in the order of elimination.
    pub(super) fn place(&self, function: usize) -> usize {
        self.elimination.symbolic.perm().map_or(function, |order| order.arrays().1[function])
    }

    /// The logarithm of the determinant of the matrix, with the ridge.
    pub(super) fn log_determinant(&self) -> f64 {
        let of_pivots: f64 = self.pivots().into_iter().map(f64::ln).sum();
        of_pivots - 2.0 * self.scale.iter().map(|scale| scale.ln()).sum::<f64>()
    }

    /// v'Mv / v'Dv, where v is the solution for the unit vector of a function.
    fn curvature(&self, function: usize, sizes: &[f64]) -> f64 {
        let mut unit = vec![0.0; self.scale.len()];
        if self.matrix.at(function, function) == 0.0 {
            return 0.0;
        }
        unit[function] = 1.0;
        let direction = self.solve_once(&unit);
        let sizes = sizes.iter().zip(self.matrix.diagonal()).map(|(size, whole)| size.min(whole));
        let square: f64 = direction.iter().zip(sizes).map(|(x, size)| x * x * size).sum();
        self.matrix.form(&direction).max(0.0) / square
    }

    /// Squares of the diagonal of the factor, in the order of elimination.
    fn pivots(&self) -> Vec<f64> {
        let square = |entry: f64| entry * entry;
        match self.elimination.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(simplicial) => {
                let starts = &simplicial.col_ptr()[..simplicial.ncols()];
                starts.iter().map(|&start| square(self.values[start])).collect()
            }
            SymbolicCholeskyRaw::Supernodal(raw) => {
                let factor = supernodal::SupernodalLltRef::new(raw, &self.values);
                let nodes = (0..raw.n_supernodes()).map(|node| factor.supernode(node).val());
                let diagonals = nodes.flat_map(|block| (0..block.ncols()).map(move |at| block[(at, at)]));
                diagonals.map(square).collect()
            }
        }
    }
}

fn pattern(matrix: &Symmetric) -> SymbolicSparseColMatRef<'_, usize> {
    // Rows of the upper triangle are columns of the lower one.
    let count = matrix.len();
    SymbolicSparseColMatRef::new_checked(count, count, &matrix.offsets, None, &matrix.columns)
}

fn too_large(functions: usize) -> Error {
    let what = format!("not enough memory to solve equations of {functions} functions: use fewer knots");
    Error::new(ErrorKind::Memory, what)
}

#[cfg(test)]
mod tests {
    use super::super::normal_equations::Rows;
    use super::*;

    /// A chain with a strong diagonal, long enough for supernodes, or a full matrix.
    fn matrix(count: usize, reach: usize) -> Symmetric {
        let mut rows = Rows::new(count, 1);
        for row in 0..count {
            let entries: Vec<(u32, f64)> = (row..count.min(row + reach))
                .map(|column| (column as u32, if column == row { 2.0 * reach as f64 } else { -0.5 }))
                .collect();
            rows.add(row, 0, 1.0 + row as f64, &entries);
        }
        Symmetric::of_rows(&rows, |_| true)
    }

    #[test]
    fn solutions_solve_the_equations() {
        for (count, reach) in [(1, 1), (40, 3), (300, 300), (500, 60)] {
            let matrix = matrix(count, reach);
            let elimination = Elimination::of(&matrix).unwrap();
            let factor = elimination.factor(&matrix).unwrap();
            let expected: Vec<f64> = (0..count).map(|i| (i as f64).sin()).collect();
            let found = factor.solve(&matrix.times(&expected));
            let error = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(error < 1e-13, "{count} {reach}: {error}");
            let diagonal: Vec<f64> = matrix.diagonal().collect();
            assert!(factor.weak(&diagonal).is_empty());
            assert_eq!(factor.pivots().len(), count);
        }
    }

    #[test]
    fn functions_that_add_nothing_are_weak() {
        for (count, reach) in [(30, 2), (300, 100)] {
            let mut matrix = matrix(count, reach);
            // The last row keeps only zeros.
            let last = count - 1;
            for row in 0..count {
                for at in matrix.offsets[row]..matrix.offsets[row + 1] {
                    if matrix.columns[at] == last {
                        matrix.values[at] = 0.0;
                    }
                }
            }
            let elimination = Elimination::of(&matrix).unwrap();
            let diagonal: Vec<f64> = matrix.diagonal().collect();
            let weak = elimination.factor(&matrix).unwrap().weak(&diagonal);
            assert_eq!(weak.len(), 1);
            assert_eq!(weak[0].0, last);
        }
    }
}

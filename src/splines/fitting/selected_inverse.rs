//! The entries of an inverse at the places of its sparse Cholesky factor, and what follows from them: traces.
//!
//! Let M = LL', and let R be the rows of the factor below the diagonal block of some columns J. With
//! Y = L_RJ L_JJ^-1, the inverse Z has Z_RJ = -Z_RR Y and Z_JJ = (L_JJ L_JJ')^-1 - Y' Z_RJ. Columns are done
//! from the last to the first. Rows of one column of a factor have entries between each other, so Z_RR is
//! known.
//!
//! Source: Takahashi, Fagan and Chin 1973; Erisman and Tinney 1975.

use std::ops::Range;

use super::cholesky::Factor;
use super::symmetric::Symmetric;
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::sparse::linalg::cholesky::{SymbolicCholesky, SymbolicCholeskyRaw};
use faer::{Accum, Mat, MatMut, MatRef, Par};

/// Entries of the inverse of a factored matrix.
pub(super) struct SelectedInverse<'a> {
    blocks: Blocks<'a>,
    /// In the layout of the values of the factor.
    values: Vec<f64>,
}

impl<'a> SelectedInverse<'a> {
    /// Computes the entries of the inverse of the scaled matrix.
    ///
    /// Cost: about that of two factorisations. Memory: that of the factor.
    fn of(blocks: Blocks<'a>) -> SelectedInverse<'a> {
        let mut inverse = SelectedInverse { values: vec![0.0; blocks.values().len()], blocks };
        let mut rows = Vec::new();
        for block in (0..inverse.blocks.len()).rev() {
            inverse.complete(block, &mut rows);
        }
        inverse
    }

    /// Computes the entries of one block of columns, from those of later blocks.
    fn complete(&mut self, block: usize, rows: &mut Vec<usize>) {
        let (columns, below) = (self.blocks.columns(block).len(), self.blocks.below(block).len());
        let factor = MatRef::from_column_major_slice(
            &self.blocks.values()[self.blocks.range(block)],
            columns + below,
            columns,
        );
        let (diagonal, lower) = factor.split_at_row(columns);
        let mut quotient = lower.to_owned();
        solve_upper_triangular_in_place(diagonal.transpose(), quotient.transpose_mut(), Par::Seq);
        let mut root = Mat::<f64>::identity(columns, columns);
        solve_lower_triangular_in_place(diagonal, root.as_mut(), Par::Seq);
        let known = self.known(block, rows);
        let range = self.blocks.range(block);
        let own = MatMut::from_column_major_slice_mut(&mut self.values[range], columns + below, columns);
        let (mut of_diagonal, mut of_lower) = own.split_at_row_mut(columns);
        matmul(of_lower.as_mut(), Accum::Replace, &known, &quotient, -1.0, Par::Seq);
        matmul(of_diagonal.as_mut(), Accum::Replace, root.transpose(), &root, 1.0, Par::Seq);
        matmul(of_diagonal, Accum::Add, quotient.transpose(), of_lower.as_ref(), -1.0, Par::Seq);
    }

    /// The entries of the inverse between all rows below a block; both triangles.
    fn known(&self, block: usize, rows: &mut Vec<usize>) -> Mat<f64> {
        let below = self.blocks.below(block);
        let mut known = Mat::zeros(below.len(), below.len());
        let mut first = 0;
        while first < below.len() {
            let of = self.blocks.of_column(below[first]);
            let columns = self.blocks.columns(of);
            let end = first + below[first..].partition_point(|&row| row < columns.end);
            self.blocks.places(of, &below[first..], rows);
            let values = &self.values[self.blocks.range(of)];
            let height = columns.len() + self.blocks.below(of).len();
            for column in first..end {
                let values = &values[(below[column] - columns.start) * height..][..height];
                for (row, &place) in (column..).zip(&rows[column - first..]) {
                    known[(row, column)] = values[place];
                    known[(column, row)] = values[place];
                }
            }
            first = end;
        }
        known
    }

    /// The entry at two places of the order of elimination.
    fn at(&self, a: usize, b: usize) -> f64 {
        let (column, row) = (a.min(b), a.max(b));
        let block = self.blocks.of_column(column);
        let columns = self.blocks.columns(block);
        let height = columns.len() + self.blocks.below(block).len();
        let place = self.blocks.place(block, row);
        self.values[self.blocks.range(block).start + (column - columns.start) * height + place]
    }
}

/// The entries of F^-1 at the places of entries of a matrix, which must be places of entries of F.
///
/// Cost and accuracy: as [`trace_of_quotient`].
pub(super) fn selected(factor: &Factor, places: &Symmetric) -> Symmetric {
    let inverse = SelectedInverse::of(factor.blocks());
    let (scale, place) = (factor.scale(), |function| factor.place(function));
    let mut found = places.clone();
    for row in 0..places.len() {
        for at in places.offsets[row]..places.offsets[row + 1] {
            let column = places.columns[at];
            found.values[at] = scale[row] * scale[column] * inverse.at(place(row), place(column));
        }
    }
    found
}

/// The trace of F^-1 N for a factored matrix F. The entries of N must be at places of entries of F.
///
/// Cost: that of about two factorisations. Accuracy: rounding errors, and the ridge of the factors.
pub(super) fn trace_of_quotient(factor: &Factor, matrix: &Symmetric) -> f64 {
    let inverse = SelectedInverse::of(factor.blocks());
    let (scale, place) = (factor.scale(), |function| factor.place(function));
    let mut trace = 0.0;
    for row in 0..matrix.len() {
        for (column, value) in matrix.row(row).filter(|&(_, value)| value != 0.0) {
            let twice = if row == column { 1.0 } else { 2.0 };
            trace += twice * value * scale[row] * scale[column] * inverse.at(place(row), place(column));
        }
    }
    trace
}

/// Blocks of columns of a factor. Rows and columns are numbered in the order of elimination.
///
/// The values of a block are a full matrix, column by column: first the rows of its own columns, of which
/// only the lower triangle counts, and then the rows below.
#[derive(Debug, Clone, Copy)]
pub(super) struct Blocks<'a> {
    symbolic: &'a SymbolicCholesky<usize>,
    values: &'a [f64],
}

impl<'a> Blocks<'a> {
    pub(super) fn new(symbolic: &'a SymbolicCholesky<usize>, values: &'a [f64]) -> Blocks<'a> {
        Blocks { symbolic, values }
    }

    pub(super) fn len(&self) -> usize {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(raw) => raw.ncols(),
            SymbolicCholeskyRaw::Supernodal(raw) => raw.n_supernodes(),
        }
    }

    pub(super) fn values(&self) -> &'a [f64] {
        self.values
    }

    /// Which values are those of a block.
    pub(super) fn range(&self, block: usize) -> Range<usize> {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(raw) => raw.col_ptr()[block]..raw.col_ptr()[block + 1],
            SymbolicCholeskyRaw::Supernodal(raw) => {
                raw.col_ptr_for_val()[block]..raw.col_ptr_for_val()[block + 1]
            }
        }
    }

    pub(super) fn columns(&self, block: usize) -> Range<usize> {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(_) => block..block + 1,
            SymbolicCholeskyRaw::Supernodal(raw) => raw.supernode_begin()[block]..raw.supernode_end()[block],
        }
    }

    /// The rows below the columns of a block, in order.
    pub(super) fn below(&self, block: usize) -> &'a [usize] {
        match self.symbolic.raw() {
            // The first row of a column is the diagonal.
            SymbolicCholeskyRaw::Simplicial(raw) => &raw.row_idx()[self.range(block)][1..],
            SymbolicCholeskyRaw::Supernodal(raw) => raw.supernode(block).pattern(),
        }
    }

    pub(super) fn of_column(&self, column: usize) -> usize {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(_) => column,
            SymbolicCholeskyRaw::Supernodal(raw) => raw.supernode_end().partition_point(|&end| end <= column),
        }
    }

    /// The place of a row in the columns of a block, which must have it.
    pub(super) fn place(&self, block: usize, row: usize) -> usize {
        let (columns, below) = (self.columns(block), self.below(block));
        match row < columns.end {
            true => row - columns.start,
            false => columns.len() + below.partition_point(|&other| other < row),
        }
    }

    /// The places of rows in order, as [`Blocks::place`], in one walk.
    pub(super) fn places(&self, block: usize, rows: &[usize], places: &mut Vec<usize>) {
        let (columns, below) = (self.columns(block), self.below(block));
        places.clear();
        let mut next = 0;
        for &row in rows {
            if row < columns.end {
                places.push(row - columns.start);
                continue;
            }
            while below[next] < row {
                next += 1;
            }
            places.push(columns.len() + next);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::cholesky::Elimination;
    use super::super::normal_equations::Rows;
    use super::*;

    /// The equations of a grid of squares, with random entries, and a part of them.
    fn matrices(side: usize) -> [Symmetric; 2] {
        let mut random = spmesh_base::random::Random::new(side as u64);
        let mut number = || random.bits() as f64 / u64::MAX as f64 - 0.5;
        let [mut whole, mut part] = [(); 2].map(|()| Rows::new(side * side, 1));
        for row in 0..side * side {
            let mut columns = vec![row];
            columns.extend((row % side + 1 < side).then_some(row + 1));
            columns.extend((row / side + 1 < side).then_some(row + side));
            for column in columns {
                let value = if column == row { 5.0 } else { number() };
                whole.add(row, 0, 1.0, &[(column as u32, value)]);
                part.add(row, 0, number(), &[(column as u32, 1.0)]);
            }
        }
        [whole, part].map(|rows| Symmetric::of_rows(&rows, |_| true))
    }

    /// The inverse by Gauss and Jordan's elimination, and the logarithm of the determinant.
    fn inverse(matrix: &Symmetric) -> (Vec<Vec<f64>>, f64) {
        let count = matrix.len();
        let mut rows: Vec<Vec<f64>> = (0..count)
            .map(|i| {
                let unit = (0..count).map(|j| if i == j { 1.0 } else { 0.0 });
                (0..count).map(|j| matrix.at(i, j)).chain(unit).collect()
            })
            .collect();
        let mut logarithm = 0.0;
        for i in 0..count {
            let pivot = rows[i][i];
            logarithm += pivot.ln();
            rows[i].iter_mut().for_each(|entry| *entry /= pivot);
            let own = rows[i].clone();
            for (_, row) in rows.iter_mut().enumerate().filter(|&(other, _)| other != i) {
                let factor = row[i];
                row.iter_mut().zip(&own).for_each(|(entry, own)| *entry -= factor * own);
            }
        }
        (rows.into_iter().map(|row| row[count..].to_vec()).collect(), logarithm)
    }

    #[test]
    fn traces_and_determinants_are_those_of_full_matrices() {
        // Factors of few functions have columns of their own; the others have blocks of columns.
        for side in [1, 2, 5, 9, 17] {
            let [whole, part] = matrices(side);
            let elimination = Elimination::of(&whole).unwrap();
            let factor = elimination.factor(&whole).unwrap();
            let (inverse, logarithm) = inverse(&whole);
            let count = whole.len();
            let pairs = (0..count).flat_map(|i| (0..count).map(move |j| (i, j)));
            let expected: f64 = pairs.map(|(i, j)| inverse[i][j] * part.at(i, j)).sum();
            let found = trace_of_quotient(&factor, &part);
            assert!((found - expected).abs() < 1e-10 * count as f64, "{side}: {found}, {expected}");
            let entries = selected(&factor, &whole);
            let off = (0..count).flat_map(|i| entries.row(i).map(move |(j, found)| (i, j, found)));
            assert!(off.into_iter().all(|(i, j, found)| (found - inverse[i][j]).abs() < 1e-11));
            assert!((factor.log_determinant() - logarithm).abs() < 1e-10 * count as f64);
        }
    }
}

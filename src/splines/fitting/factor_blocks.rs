//! A sparse Cholesky factor as blocks of columns with the same rows below their diagonal.

use faer::sparse::linalg::cholesky::{SymbolicCholesky, SymbolicCholeskyRaw};
use std::ops::Range;

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

    /// Number of blocks.
    pub(super) fn len(&self) -> usize {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(raw) => raw.ncols(),
            SymbolicCholeskyRaw::Supernodal(raw) => raw.n_supernodes(),
        }
    }

    /// The values of all blocks.
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

    /// The columns of a block.
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

    /// The block of a column.
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

//! Symmetric sparse matrices: their upper triangles, row by row.

use super::normal_equations::Rows;

/// A symmetric sparse matrix. Shape: 16 bytes per entry of the upper triangle.
#[derive(Debug, Clone, PartialEq)]
pub struct Symmetric {
    /// For each row, the index of its first entry; at the end, the number of entries.
    pub(super) offsets: Vec<usize>,
    /// Columns of entries, from the row on; the diagonal is always there, and first.
    pub(super) columns: Vec<usize>,
    pub(super) values: Vec<f64>,
}

impl Symmetric {
    /// The sum of some parts of rows.
    pub(super) fn of_rows(rows: &Rows, is_summed: impl Fn(usize) -> bool) -> Symmetric {
        let mut matrix = Symmetric { offsets: vec![0], columns: Vec::new(), values: Vec::new() };
        for row in 0..rows.len() {
            let mut is_first = true;
            for (column, parts) in rows.row(row) {
                if is_first && column != row {
                    matrix.push(row, 0.0);
                }
                is_first = false;
                let summed = parts.iter().enumerate().filter(|&(part, _)| is_summed(part));
                matrix.push(column, summed.map(|(_, value)| value).sum());
            }
            if is_first {
                matrix.push(row, 0.0);
            }
            matrix.offsets.push(matrix.columns.len());
        }
        matrix
    }

    fn push(&mut self, column: usize, value: f64) {
        self.columns.push(column);
        self.values.push(value);
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of entries of the upper triangle that are held.
    pub fn entries_len(&self) -> usize {
        self.values.len()
    }

    /// The entries (column, value) of a row from the diagonal on.
    pub fn row(&self, row: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.offsets[row]..self.offsets[row + 1];
        self.columns[range.clone()].iter().copied().zip(self.values[range].iter().copied())
    }

    /// The diagonal.
    pub fn diagonal(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        self.offsets[..self.len()].iter().map(|&first| self.values[first])
    }

    /// The entry at a row and a column: zero where nothing is held.
    pub fn at(&self, row: usize, column: usize) -> f64 {
        let (row, column) = (row.min(column), row.max(column));
        let range = self.offsets[row]..self.offsets[row + 1];
        let place = self.columns[range.clone()].binary_search(&column);
        place.map_or(0.0, |place| self.values[range.start + place])
    }

    /// The sum of the diagonal.
    pub fn trace(&self) -> f64 {
        self.diagonal().sum()
    }

    /// The product with a vector.
    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; self.len()];
        for row in 0..self.len() {
            let mut sum = 0.0;
            for (column, value) in self.row(row) {
                sum += value * x[column];
                if column != row {
                    product[column] += value * x[row];
                }
            }
            product[row] += sum;
        }
        product
    }

    /// The quadratic form x'Mx.
    pub fn form(&self, x: &[f64]) -> f64 {
        self.times(x).iter().zip(x).map(|(product, x)| product * x).sum()
    }

    /// This matrix plus `factor` times another of the same size; it has the entries of both.
    pub fn plus(&self, factor: f64, other: &Symmetric) -> Symmetric {
        debug_assert_eq!(self.len(), other.len());
        let mut sum = Symmetric { offsets: vec![0], columns: Vec::new(), values: Vec::new() };
        for row in 0..self.len() {
            let (mut left, mut right) = (self.row(row).peekable(), other.row(row).peekable());
            loop {
                let column = match (left.peek(), right.peek()) {
                    (Some(&(a, _)), Some(&(b, _))) => a.min(b),
                    (Some(&(a, _)), None) | (None, Some(&(a, _))) => a,
                    (None, None) => break,
                };
                let of_left = left.next_if(|entry| entry.0 == column).map_or(0.0, |entry| entry.1);
                let of_right = right.next_if(|entry| entry.0 == column).map_or(0.0, |entry| entry.1);
                sum.push(column, of_left + factor * of_right);
            }
            sum.offsets.push(sum.columns.len());
        }
        sum
    }

    /// Adds to an entry of the diagonal.
    pub(super) fn add_to_diagonal(&mut self, row: usize, value: f64) {
        self.values[self.offsets[row]] += value;
    }

    /// The matrix with rows and columns multiplied by factors, and a constant added to the diagonal.
    pub(super) fn scaled(&self, factors: &[f64], to_diagonal: f64) -> Symmetric {
        let mut scaled = self.clone();
        for row in 0..self.len() {
            let range = self.offsets[row]..self.offsets[row + 1];
            for at in range.clone() {
                scaled.values[at] *= factors[row] * factors[self.columns[at]];
            }
            scaled.values[range.start] += to_diagonal;
        }
        scaled
    }
}

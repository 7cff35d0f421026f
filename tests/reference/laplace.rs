//! Determinants by definition.

/// A determinant by Laplace's expansion along the first row.
pub fn determinant<const N: usize>(m: [[i64; N]; N]) -> i64 {
    fn minor(rows: &[Vec<i64>]) -> i64 {
        let Some((first, rest)) = rows.split_first() else { return 1 };
        let without = |column: usize| {
            rest.iter().map(|row| [&row[..column], &row[column + 1..]].concat()).collect::<Vec<_>>()
        };
        let sign = |column: usize| if column.is_multiple_of(2) { 1 } else { -1 };
        (0..first.len()).map(|column| sign(column) * first[column] * minor(&without(column))).sum()
    }
    minor(&m.map(|row| row.to_vec()))
}

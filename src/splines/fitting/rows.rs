//! Rows of symmetric sparse matrices while entries are added to them.

/// The upper triangle of a symmetric matrix, or of several matrices with entries at the same places, its
/// *parts*.
#[derive(Debug, Clone)]
pub(super) struct Rows {
    parts: usize,
    rows: Vec<Row>,
}

#[derive(Debug, Clone, Default)]
struct Row {
    /// Increasing.
    columns: Vec<u32>,
    /// For each column, the values of all parts.
    values: Vec<f64>,
}

impl Rows {
    pub(super) fn new(count: usize, parts: usize) -> Rows {
        Rows { parts, rows: vec![Row::default(); count] }
    }

    pub(super) fn len(&self) -> usize {
        self.rows.len()
    }

    /// Adds `factor` times the values in `entries`, which are in order of columns, to a row.
    ///
    /// A row has few columns, and consecutive entries are close to each other in it, so a linear walk finds
    /// them.
    #[inline]
    pub(super) fn add(&mut self, row: usize, part: usize, factor: f64, entries: &[(u32, f64)]) {
        let Row { columns, values } = &mut self.rows[row];
        let mut place = 0;
        for &(column, value) in entries {
            while columns.get(place).is_some_and(|&other| other < column) {
                place += 1;
            }
            if columns.get(place) != Some(&column) {
                columns.insert(place, column);
                let at = place * self.parts;
                values.splice(at..at, std::iter::repeat_n(0.0, self.parts));
            }
            values[place * self.parts + part] += factor * value;
        }
    }

    /// The entries of a row: columns with the values of all parts.
    pub(super) fn row(&self, row: usize) -> impl Iterator<Item = (usize, &[f64])> {
        let Row { columns, values } = &self.rows[row];
        columns.iter().map(|&column| column as usize).zip(values.chunks_exact(self.parts))
    }

    /// Merges the rows of several shards: row i is in shard i modulo their number.
    pub(super) fn interleaved(shards: Vec<Rows>) -> Rows {
        let parts = shards.first().map_or(1, |rows| rows.parts);
        let count = shards.iter().map(Rows::len).sum();
        let mut shards: Vec<_> = shards.into_iter().map(|rows| rows.rows.into_iter()).collect();
        let turns = shards.len().max(1);
        let rows = (0..count).filter_map(|row| shards[row % turns].next()).collect();
        Rows { parts, rows }
    }
}

//! Diagonals that links of single knots must have, whatever the rule is.

/// Required diagonals in the links of some knots; the rule triangulates the pieces between them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Diagonals {
    /// Each row is a knot and the ends of a diagonal in its link; sorted.
    rows: Vec<(u32, [u32; 2])>,
}

impl Diagonals {
    pub(super) fn new(mut rows: Vec<(u32, [u32; 2])>) -> Diagonals {
        rows.sort_unstable();
        Diagonals { rows }
    }

    /// Whether there are no diagonals.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The ends of the diagonals in the link of a set; there are some only for single knots.
    ///
    /// Cost: a binary search.
    pub fn of(&self, set: &[u32]) -> impl ExactSizeIterator<Item = [u32; 2]> + '_ {
        let rows = match *set {
            [knot] => {
                let start = self.rows.partition_point(|row| row.0 < knot);
                &self.rows[start..start + self.rows[start..].partition_point(|row| row.0 == knot)]
            }
            _ => &[],
        };
        rows.iter().map(|row| row.1)
    }
}

//! Diagonals that links of single knots must have, whatever the rule is.

use crate::configurations::polygon::Triangulator;
use crate::predicates::Predicates2;
use spmesh_core::error::{Error, Result};

/// For some knots, diagonals of their links: the rule triangulates what is left between them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Diagonals {
    /// The knot and the ends, sorted.
    rows: Vec<(u32, [u32; 2])>,
}

impl Diagonals {
    pub(super) fn new(mut rows: Vec<(u32, [u32; 2])>) -> Diagonals {
        rows.sort_unstable();
        Diagonals { rows }
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The ends of those of a set; none if it is not a single knot. Cost: a binary search.
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

impl<P: Predicates2> Triangulator<'_, P> {
    /// Triangulates the polygon, and has the given diagonals among its edges.
    ///
    /// # Errors
    /// What is no diagonal of it, or crosses another.
    pub(in crate::configurations) fn by_diagonals(&mut self, diagonals: Vec<[u32; 2]>) -> Result<()> {
        let mut pieces = vec![self.polygon.clone()];
        for [p, q] in diagonals {
            let place = |piece: &[u32], v| piece.iter().position(|&other| other == v);
            let holds = |piece: &Vec<u32>| place(piece, p).is_some() && place(piece, q).is_some();
            let Some(mut piece) = pieces.iter().position(holds).map(|at| pieces.swap_remove(at)) else {
                return Err(self.no_diagonal([p, q]));
            };
            let start = place(&piece, p).unwrap_or(0);
            piece.rotate_left(start);
            let end = place(&piece, q).unwrap_or(0);
            self.take(&piece);
            if end < 2 || end + 1 >= piece.len() || !self.sees(0, end) {
                return Err(self.no_diagonal([p, q]));
            }
            pieces.push(piece[..=end].to_vec());
            pieces.push([&piece[end..], &piece[..1]].concat());
        }
        for piece in pieces {
            self.take(&piece);
            if piece.len() == 3 { self.emit(0, 1, 2)? } else { self.by_rule()? }
        }
        Ok(())
    }

    /// Makes a piece the polygon.
    fn take(&mut self, piece: &[u32]) {
        self.polygon.clear();
        self.polygon.extend_from_slice(piece);
        self.sight.clear();
        self.sight.resize(piece.len() * piece.len(), None);
    }

    #[cold]
    fn no_diagonal(&self, [p, q]: [u32; 2]) -> Error {
        self.failure(&format!("the edge from {p} to {q} that it should have is no diagonal of it"))
    }
}

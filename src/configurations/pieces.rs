//! Triangulates a link with required diagonals: they cut it into pieces, which the rule triangulates.

use super::polygon::Triangulator;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::Predicates2;

impl<P: Predicates2> Triangulator<'_, P> {
    /// Triangulates the polygon such that the given diagonals are edges.
    pub(super) fn by_diagonals(&mut self, diagonals: Vec<[u32; 2]>) -> Result<()> {
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

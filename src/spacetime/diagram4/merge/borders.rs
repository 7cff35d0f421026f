//! Finds the facets of simplices that are no borders of cells.

use super::AHEAD;
use crate::diagram4::simplices::{Coefficient, Complex, FACETS};
use spmesh_base::prefetch::prefetch;
use spmesh_delaunay::parallel::for_each;
use std::num::NonZeroUsize;

/// Bits for each simplex: those of facets across which the neighbour is on the same sphere, or in the same
/// hyperplane, and those of dead and of visited simplices.
#[derive(Clone)]
pub(super) struct Borders(Vec<u8>);

/// Simplices that a thread tests at a time.
const PIECE: usize = 1 << 14;

const DEAD: u8 = 1 << FACETS;
const VISITED: u8 = DEAD << 1;

impl Borders {
    /// Tests all facets. The search for cells, which jumps about in memory, then needs no spheres; this pass
    /// through the memory knows in time what to prefetch.
    pub(super) fn of<C: Coefficient>(complex: &Complex<C>, threads: NonZeroUsize) -> Borders {
        let count = complex.simplices.len();
        let bits = |simplex: usize| {
            complex.fetch_spheres_around((simplex + AHEAD).min(count - 1));
            if complex.is_dead(simplex) {
                return DEAD;
            }
            (0..FACETS).fold(0, |bits, side| bits | u8::from(complex.is_cospherical(simplex, side)) << side)
        };
        let mut borders = vec![0; count];
        let pieces = borders.chunks_mut(PIECE).enumerate();
        for_each(threads, pieces, |(number, piece)| {
            (number * PIECE..).zip(piece).for_each(|(simplex, border)| *border = bits(simplex));
        });
        Borders(borders)
    }

    /// Whether a simplex is alive and was not visited before.
    #[inline(always)]
    pub(super) fn is_new(&self, simplex: usize) -> bool {
        self.0[simplex] < DEAD
    }

    /// Visits a simplex if it `joins`.
    #[inline(always)]
    pub(super) fn visit(&mut self, simplex: usize, joins: bool) {
        self.0[simplex] |= if joins { VISITED } else { 0 };
    }

    /// Prefetches the bits of a simplex.
    #[inline(always)]
    pub(super) fn fetch(&self, simplex: usize) {
        prefetch(&self.0, simplex);
    }

    /// The bits of the facets of a simplex that are inside of a cell.
    #[inline(always)]
    pub(super) fn inner(&self, simplex: usize) -> u8 {
        self.0[simplex] & (DEAD - 1)
    }
}

//! Finds the facets of simplices that are no borders of cells.

use super::AHEAD;
use crate::diagram4::simplices::{Coefficient, Complex, FACETS};

/// Bits for each simplex: those of facets across which the neighbour is on the same sphere, or in the same
/// hyperplane, and one of dead simplices.
pub(super) struct Borders(Vec<u8>);

const DEAD: u8 = 1 << FACETS;

impl Borders {
    /// Tests all facets. The search for cells, which jumps about in memory, then needs no spheres; this pass
    /// through the memory knows in time what to prefetch.
    pub(super) fn of<C: Coefficient>(complex: &Complex<C>) -> Borders {
        let count = complex.simplices.len();
        let bits = |simplex: usize| {
            complex.fetch_spheres_around((simplex + AHEAD).min(count - 1));
            if complex.is_dead(simplex) {
                return DEAD;
            }
            (0..FACETS).fold(0, |bits, side| bits | u8::from(complex.is_cospherical(simplex, side)) << side)
        };
        Borders((0..count).map(bits).collect())
    }

    #[inline(always)]
    pub(super) fn is_dead(&self, simplex: usize) -> bool {
        self.0[simplex] == DEAD
    }

    /// The bits of the facets of a simplex that are inside of a cell.
    #[inline(always)]
    pub(super) fn inner(&self, simplex: usize) -> u8 {
        self.0[simplex] & !DEAD
    }
}

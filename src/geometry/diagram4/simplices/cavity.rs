//! What a new point takes away: the simplices whose spheres it is in.

use super::coefficient::Coefficient;
use super::complex::{Complex, FACETS, Facet, facet, simplex_of};

/// How far ahead memory is fetched.
const AHEAD: usize = 3;

/// Simplices in conflict with a point, and the border around them.
///
/// Which of its neighbours a simplex in conflict is the first to meet, and which are in conflict, no
/// processor predicts: so both lists are written to each time, and it is only counted if that was meant.
#[derive(Debug, Default)]
pub(super) struct Cavity {
    dead: Vec<u32>,
    dead_count: usize,
    border: Vec<Facet>,
    border_count: usize,
}

impl Cavity {
    /// The simplices in conflict.
    pub(super) fn dead(&self) -> &[u32] {
        &self.dead[..self.dead_count]
    }

    /// The facets between them and those that stay, as facets of the former.
    pub(super) fn border(&self) -> &[Facet] {
        &self.border[..self.border_count]
    }

    /// Finds the simplices in conflict with vertex `q` from one of them, and marks them as dead.
    #[inline(always)]
    pub(super) fn find<C: Coefficient>(&mut self, complex: &mut Complex<C>, q: u32, found: usize) {
        let p = complex.lifted(q);
        (self.dead_count, self.border_count) = (0, 0);
        self.make_room();
        complex.spheres[found][4] = C::DEAD;
        self.dead[0] = found as u32;
        self.dead_count = 1;
        let mut next = 0;
        while next < self.dead_count {
            self.make_room();
            let at = self.dead[next] as usize;
            next += 1;
            if next + AHEAD < self.dead_count {
                complex.fetch_neighbours(self.dead[next + AHEAD] as usize);
            }
            let beyond = complex.simplices[at].beyond;
            for (side, beyond) in beyond.into_iter().enumerate() {
                let other = simplex_of(beyond);
                let determinant = complex.determinant(other);
                let is_alive = determinant >= C::default();
                let value = complex.value(other, &p);
                let mut is_inside = value < 0.0;
                if is_alive & !complex.is_clear(value, other) {
                    is_inside = complex.decide(other, q, &p);
                }
                let dies = is_alive & is_inside;
                complex.spheres[other][4] = if dies { C::DEAD } else { determinant };
                self.dead[self.dead_count] = other as u32;
                self.dead_count += usize::from(dies);
                self.border[self.border_count] = facet(at, side);
                self.border_count += usize::from(is_alive & !is_inside);
            }
        }
    }

    /// Makes room for all neighbours of a simplex in both lists.
    #[inline(always)]
    fn make_room(&mut self) {
        for (list, count) in [(&mut self.dead, self.dead_count), (&mut self.border, self.border_count)] {
            if list.len() < count + FACETS {
                list.resize(2 * (count + FACETS), 0);
            }
        }
    }
}

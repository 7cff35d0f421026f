//! The cavity of a new point: the simplices whose spheres contain it.

use super::coefficient::Coefficient;
use super::complex::{Complex, FACETS, Facet, facet, facet_of, simplex_of, without};
use super::lanes::{LANES, Lanes};

/// Simplices to prefetch ahead.
const AHEAD: usize = 3;

/// Simplices in conflict with a point, and the border around them.
///
/// Whether a neighbour is in conflict is unpredictable, and so is whether it was met before. To avoid
/// branches, every neighbour is written to the end of both lists, and the count of the right list is
/// incremented.
#[derive(Debug, Default)]
pub(super) struct Cavity {
    /// Each as the facet through which it was reached.
    dead: Vec<Facet>,
    dead_count: usize,
    border: Vec<Facet>,
    border_count: usize,
}

impl Cavity {
    /// The simplices in conflict, each as one of its facets.
    pub(super) fn dead(&self) -> &[Facet] {
        &self.dead[..self.dead_count]
    }

    /// The facets between them and the simplices that stay, as facets of the former.
    pub(super) fn border(&self) -> &[Facet] {
        &self.border[..self.border_count]
    }

    /// Finds the simplices in conflict with vertex `q` from one of them, and marks them as dead.
    #[inline(always)]
    pub(super) fn find<C: Coefficient, L: Lanes>(
        &mut self,
        token: L::Token,
        complex: &mut Complex<C>,
        q: u32,
        found: usize,
    ) {
        let p = complex.lifted(q);
        let head = L::new(token, [p[0], p[1], p[2], p[3]]);
        (self.dead_count, self.border_count) = (0, 0);
        self.reserve();
        complex.spheres[found][4] = C::DEAD;
        // All other simplices are reached through a facet, whose other side is dead: four facets are left.
        let across = complex.simplices[found].neighbours[0];
        let is_inside = complex.is_in_conflict(simplex_of(across), q, &p);
        let determinant = complex.determinant(simplex_of(across));
        self.sort_out(complex, facet(found, 0), across, is_inside, determinant);
        self.dead[self.dead_count] = facet(found, 0);
        self.dead_count += 1;
        let mut next = 0;
        while next < self.dead_count {
            self.reserve();
            let (at, entry) = (simplex_of(self.dead[next]), facet_of(self.dead[next]));
            next += 1;
            if next + AHEAD < self.dead_count {
                complex.fetch_neighbours(simplex_of(self.dead[next + AHEAD]));
            }
            let around = without(complex.simplices[at].neighbours, entry);
            let [a, b, c, d] = around.map(|neighbour| complex.spheres[simplex_of(neighbour)].map(C::value));
            let row = |s: [f64; 6]| L::new(token, [s[0], s[1], s[2], s[3]]);
            let [x, y, z, t] = L::columns([row(a) * head, row(b) * head, row(c) * head, row(d) * head]);
            let m = [a[4], b[4], c[4], d[4]];
            let (lifted, s) =
                (L::new(token, m) * L::new(token, [p[4]; LANES]), L::new(token, [a[5], b[5], c[5], d[5]]));
            let values = (((x + y) + (z + t)) + (lifted + s)).array();
            let mut inside = values.map(|value| value < 0.0);
            let unclear = |lane: usize| (m[lane] >= 0.0) & !complex.is_clear(values[lane], m[lane]);
            if unclear(0) | unclear(1) | unclear(2) | unclear(3) {
                for lane in 0..LANES {
                    if unclear(lane) {
                        inside[lane] = complex.decide(simplex_of(around[lane]), q, &p);
                    }
                }
            }
            for lane in 0..LANES {
                let here = facet(at, lane + usize::from(lane >= entry));
                let determinant = complex.determinant(simplex_of(around[lane]));
                self.sort_out(complex, here, around[lane], inside[lane], determinant);
            }
        }
    }

    /// Adds the simplex across a facet to the cavity, or the facet to the border, unless the simplex is dead
    /// already.
    #[inline(always)]
    fn sort_out<C: Coefficient>(
        &mut self,
        complex: &mut Complex<C>,
        here: Facet,
        across: Facet,
        is_inside: bool,
        determinant: C,
    ) {
        let is_alive = determinant >= C::default();
        let dies = is_alive & is_inside;
        complex.spheres[simplex_of(across)][4] = if dies { C::DEAD } else { determinant };
        self.dead[self.dead_count] = across;
        self.dead_count += usize::from(dies);
        self.border[self.border_count] = here;
        self.border_count += usize::from(is_alive & !is_inside);
    }

    /// Reserves space for all neighbours of a simplex in both lists.
    #[inline(always)]
    fn reserve(&mut self) {
        for (list, count) in [(&mut self.dead, self.dead_count), (&mut self.border, self.border_count)] {
            if list.len() < count + FACETS {
                list.resize(2 * (count + FACETS), 0);
            }
        }
    }
}

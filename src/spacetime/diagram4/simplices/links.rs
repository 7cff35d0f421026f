//! The star of a new point: simplices of the point and each facet of the border of its cavity. Two are
//! neighbours if they have three vertices besides the point in common.

use super::cavity::Cavity;
use super::coefficient::Coefficient;
use super::complex::{Arrays, FACETS, Facet, NO_NEIGHBOUR, facet, facet_of, simplex_of, spheres_of, without};
use super::lanes::{LANES, Lanes};
use spmesh_stream::model::cells4::Point4;

/// Slots per simplex of a star, at least. The table holds two triangles per simplex.
const SLOTS: usize = 8;

/// A triangle of the border of a cavity, and the last facet of the star that came to it.
#[derive(Debug, Clone, Copy)]
struct Slot {
    /// In increasing order.
    triangle: [u32; 3],
    /// [`NO_NEIGHBOUR`] in a free slot.
    facet: Facet,
}

const FREE: Slot = Slot { triangle: [0; 3], facet: NO_NEIGHBOUR };

/// A hash table of triangles.
#[derive(Debug, Default)]
pub(super) struct Links {
    slots: Vec<Slot>,
    /// Number of bits of an index.
    bits: u32,
}

impl Links {
    /// Empties the table and reserves slots for a star of this many simplices.
    pub(super) fn clear(&mut self, simplices: usize) {
        let size = (simplices * SLOTS).next_power_of_two();
        if self.slots.len() < size {
            self.slots.resize(size, FREE);
        }
        self.slots[..size].fill(FREE);
        self.bits = size.ilog2();
    }

    /// Links a simplex of the star to those at its triangles that came before it.
    ///
    /// `vertices` are those besides the centre, in increasing order but for the first two. At a triangle
    /// where none came before, the simplex is linked to itself: that saves an unpredictable branch.
    #[inline(always)]
    pub(super) fn link<C: Coefficient>(
        &mut self,
        arrays: &mut Arrays<'_, C>,
        new: usize,
        &[a, b, c, d]: &[u32; 4],
    ) {
        let (least, second) = (a.min(b), a.max(b));
        let mut link = |place: usize, triangle: [u32; 3]| {
            let here = facet(new, place);
            let there = self.meet(triangle, here);
            let there = if there == NO_NEIGHBOUR { here } else { there };
            arrays.set_neighbour(there, here);
            arrays.set_neighbour(here, there);
        };
        link(0, [b, c, d]);
        link(1, [a, c, d]);
        link(2, [least, second, d]);
        link(3, [least, second, c]);
    }

    /// Stores a facet at a triangle, and returns the facet stored there before.
    #[inline(always)]
    fn meet(&mut self, triangle: [u32; 3], facet: Facet) -> Facet {
        let [x, y, z] = triangle;
        let mut index = (hash(triangle) >> (64 - self.bits)) as usize;
        loop {
            let slot = &mut self.slots[index];
            let [a, b, c] = slot.triangle;
            let difference = (a ^ x) | (b ^ y) | (c ^ z);
            const { assert!(NO_NEIGHBOUR == 0) };
            // The product is zero if the slot is free or has the triangle. Two tests would be two branches,
            // one of them unpredictable.
            if u64::from(difference) * u64::from(slot.facet) == 0 {
                let there = slot.facet;
                *slot = Slot { triangle, facet };
                return there;
            }
            index = (index + 1) & ((1 << self.bits) - 1);
        }
    }
}

#[inline(always)]
fn hash([x, y, z]: [u32; 3]) -> u64 {
    const MIX: u64 = 0x9e37_79b9_7f4a_7c15;
    ((u64::from(x) << 32 | u64::from(y)) ^ u64::from(z).wrapping_mul(MIX)).wrapping_mul(MIX)
}

/// The place of the new point in its simplices.
const LAST: usize = FACETS - 1;

/// Makes a simplex of each facet of the border and vertex `q`, in the places given, and links them.
#[inline(always)]
pub(super) fn make<C: Coefficient, L: Lanes>(
    token: L::Token,
    arrays: &mut Arrays<'_, C>,
    near: &[Point4],
    q: u32,
    cavity: &Cavity,
    places: &[u32],
    links: &mut Links,
) {
    let o = near[q as usize];
    links.clear(places.len());
    for (facets, star) in cavity.border().chunks(LANES).zip(places.chunks(LANES)) {
        let last = facets.len() - 1;
        let vertices = |lane: usize| facet_vertices(arrays, facets[lane.min(last)]);
        let vertices = [vertices(0), vertices(1), vertices(2), vertices(3)];
        let spheres = spheres_of::<C, L>(token, near, &o, &vertices);
        for (lane, &new) in star.iter().enumerate() {
            let (new, outer) = (new as usize, arrays.neighbour(facets[lane]));
            arrays.set_neighbour(outer, facet(new, LAST));
            let [a, b, c, d] = vertices[lane];
            arrays.set(new, [a, b, c, d, q], spheres[lane]);
            arrays.set_neighbour(facet(new, LAST), outer);
            links.link(arrays, new, &vertices[lane]);
        }
    }
}

/// The vertices of a facet of the border, in the order that makes a positive simplex with the new point as
/// the last.
///
/// The new point, greater than all others, replaces the vertex opposite to the facet, and goes to the end,
/// past all vertices after it. The first two vertices are swapped if that turns the simplex.
#[inline(always)]
fn facet_vertices<C: Coefficient>(arrays: &Arrays<'_, C>, facet: Facet) -> [u32; 4] {
    let side = facet_of(facet);
    let [a, b, c, d] = without(arrays.vertices(simplex_of(facet)), side);
    if side.is_multiple_of(2) { [a, b, c, d] } else { [b, a, c, d] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_meet_twice_and_only_equal_ones() {
        let mut links = Links::default();
        // Few slots, so that triangles collide.
        links.clear(16);
        let triangles: Vec<[u32; 3]> =
            (0..4u32).flat_map(|i| (0..8).map(move |j| [i * 8, 800 + j * 8, u32::MAX])).collect();
        for (number, &triangle) in (1..).zip(&triangles) {
            assert_eq!(links.meet(triangle, number), 0, "no one has been there");
        }
        for (number, &triangle) in (1..).zip(&triangles) {
            assert_eq!(links.meet(triangle, 1000 + number), number);
        }
        links.clear(16);
        assert_eq!(links.meet(triangles[0], 1), 0, "the table is empty again");
    }
}

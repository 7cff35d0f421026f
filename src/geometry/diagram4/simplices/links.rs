//! Which simplices of a star are neighbours: those that have three vertices in common besides the centre.

use super::complex::{FACETS, Facet, NOBODY, Simplex, facet, facet_of, simplex_of};

/// Slots per simplex of a star, at least. Twice as many triangles as simplices are put into them.
const SLOTS: usize = 4;

/// A triangle of the border of a cavity, and the first facet of the star that was met at it.
#[derive(Debug, Clone, Copy)]
struct Slot {
    /// In increasing order.
    triangle: [u32; 3],
    /// Where it was met; [`NOBODY`] in a free slot.
    facet: Facet,
}

const FREE: Slot = Slot { triangle: [0; 3], facet: NOBODY };

/// A table of triangles.
#[derive(Debug, Default)]
pub(super) struct Links {
    slots: Vec<Slot>,
    /// Number of bits of an index.
    bits: u32,
}

impl Links {
    /// Makes room for a star of so many simplices.
    pub(super) fn clear(&mut self, simplices: usize) {
        let size = (simplices * SLOTS).next_power_of_two();
        if self.slots.len() < size {
            self.slots.resize(size, FREE);
        }
        self.slots[..size].fill(FREE);
        self.bits = size.ilog2();
    }

    /// Links a simplex of the star with those at its triangles that came before it, if they have come.
    ///
    /// `side` is that of the facet opposite to the centre. What has no neighbour yet leads to [`NOBODY`],
    /// whose own links are written but mean nothing: that saves asking which of the two came first, a coin
    /// toss for the processor.
    #[inline(always)]
    pub(super) fn link(
        &mut self,
        simplices: &mut [Simplex],
        new: usize,
        vertices: &[u32; FACETS],
        side: usize,
    ) {
        let [a, b, c, d] = sorted(vertices, side);
        for (left_out, [x, y, z]) in [(a, [b, c, d]), (b, [a, c, d]), (c, [a, b, d]), (d, [a, b, c])] {
            let place = (left_out & PLACE) as usize;
            let here = facet(new, place);
            let there = self.meet([x, y, z].map(|vertex| vertex & !PLACE), here);
            simplices[new].beyond[place] = there;
            simplices[simplex_of(there)].beyond[facet_of(there)] = here;
        }
    }

    /// Leaves a facet at a triangle, and takes what has been left there.
    #[inline(always)]
    fn meet(&mut self, triangle: [u32; 3], facet: Facet) -> Facet {
        let [x, y, z] = triangle;
        let mut index = (hash(triangle) >> (64 - self.bits)) as usize;
        loop {
            let slot = &mut self.slots[index];
            let [a, b, c] = slot.triangle;
            let difference = (a ^ x) | (b ^ y) | (c ^ z);
            const { assert!(NOBODY == 0) };
            // The product is zero if the slot is free or has the triangle. Two questions would be two
            // branches, and one of them a coin toss.
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

/// Bits of the place of a vertex in its simplex.
const PLACE: u32 = 7;

/// The vertices of a simplex but one in increasing order, above the bits for their places.
#[inline(always)]
fn sorted(vertices: &[u32; FACETS], side: usize) -> [u32; 4] {
    let mut words: [u32; 4] = std::array::from_fn(|i| {
        let place = i + usize::from(i >= side);
        vertices[place] << 3 | place as u32
    });
    let mut order = |i: usize, j: usize| {
        let (less, more) = (words[i].min(words[j]), words[i].max(words[j]));
        (words[i], words[j]) = (less, more);
    };
    order(0, 1);
    order(2, 3);
    order(0, 2);
    order(1, 3);
    order(1, 2);
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_meet_twice_and_only_equal_ones() {
        let mut links = Links::default();
        // Room for few: slots collide.
        links.clear(16);
        let triangles: Vec<[u32; 3]> =
            (0..4u32).flat_map(|i| (0..8).map(move |j| [i * 8, 800 + j * 8, !PLACE])).collect();
        for (number, &triangle) in (1..).zip(&triangles) {
            assert_eq!(links.meet(triangle, number), 0, "no one has been there");
        }
        for (number, &triangle) in (1..).zip(&triangles) {
            assert_eq!(links.meet(triangle, 1000 + number), number);
        }
        links.clear(16);
        assert_eq!(links.meet(triangles[0], 1), 0, "the table is empty again");
    }

    #[test]
    fn vertices_are_sorted_with_their_places() {
        let vertices = [7, u32::MAX, 3, 9, 0];
        for side in 0..FACETS {
            let words = sorted(&vertices, side);
            assert!(words.is_sorted());
            let mut places: Vec<usize> = words.iter().map(|word| (word & PLACE) as usize).collect();
            assert!(words.iter().all(|word| word >> 3 == vertices[(word & PLACE) as usize] << 3 >> 3));
            places.sort_unstable();
            assert!(places.iter().copied().eq((0..FACETS).filter(|&place| place != side)));
        }
    }
}

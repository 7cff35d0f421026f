//! The star of a new point, which takes the place of its cavity.

use super::cavity::Cavity;
use super::complex::{Complex, Facet, tetrahedron_of};
use super::words::Trusted;

/// Up to this number of vertices, edges are found in a table that stays in the first-level cache.
const STRIDE: usize = 64;

/// Buffers to write stars with.
#[derive(Debug)]
pub(super) struct Star {
    /// The places of its tetrahedra.
    slots: Vec<u32>,
    /// For each directed edge of the border the facet of the star to its left.
    left: Box<[Facet; STRIDE * STRIDE]>,
}

impl Default for Star {
    fn default() -> Star {
        Star { slots: Vec::new(), left: Box::new([0; STRIDE * STRIDE]) }
    }
}

impl Star {
    /// Writes the star of vertex `q` into the complex, which must have room for it; returns one of its
    /// tetrahedra.
    #[inline(always)]
    pub(super) fn write(&mut self, complex: &mut Complex<'_>, cavity: &Cavity, q: u32) -> u32 {
        let wanted = cavity.border().len();
        self.slots.clear();
        self.slots.extend(cavity.entered().iter().map(|face| tetrahedron_of(face.beyond())));
        while self.slots.len() < wanted {
            let slot = complex.allocate();
            self.slots.push(slot);
        }
        complex.free.extend(self.slots.drain(wanted..));
        if cavity.vertices().len() <= STRIDE {
            self.write_by_table(complex, cavity, q);
        } else {
            self.write_by_sorting(complex, cavity, q);
        }
        self.slots[wanted - 1]
    }

    /// A tetrahedron of the star has the new vertex as its corner 0, then those of the facet. Across from a
    /// corner of the facet is what lies to the left of the other two in opposite direction.
    #[inline(always)]
    fn write_by_table(&mut self, complex: &mut Complex<'_>, cavity: &Cavity, q: u32) {
        let wanted = cavity.border().len();
        // SAFETY: there are `wanted` facets, and slots; the corners of facets have numbers below that of
        // vertices, which is at most STRIDE.
        let (mut left, slots, border, vertices) = unsafe {
            let (border, vertices) = (&cavity.border[..], &cavity.vertices[..]);
            (
                Trusted::new(&mut self.left[..]),
                Trusted::new(&self.slots[..]),
                Trusted::new(border),
                Trusted::new(vertices),
            )
        };
        let edge = |a: u32, b: u32| a as usize * STRIDE + b as usize;
        for i in 0..wanted {
            let ([a, b, c], slot) = (border[i].corners(), slots[i]);
            left[edge(b, c)] = slot + 1;
            left[edge(c, a)] = slot + 2;
            left[edge(a, b)] = slot + 3;
        }
        for i in 0..wanted {
            let (face, slot) = (border[i], slots[i]);
            let ([a, b, c], beyond) = (face.corners(), face.beyond());
            let [u, v, w] = [vertices[a as usize], vertices[b as usize], vertices[c as usize]];
            let facets = [left[edge(c, b)], left[edge(a, c)], left[edge(b, a)]];
            complex.write(slot, [q, u, v, w], [beyond, facets[0], facets[1], facets[2]]);
            complex.set_neighbour(beyond, slot);
        }
    }

    /// The same for any number of vertices.
    #[cold]
    #[inline(never)]
    fn write_by_sorting(&mut self, complex: &mut Complex<'_>, cavity: &Cavity, q: u32) {
        let (border, numbered) = (cavity.border(), cavity.vertices());
        let mut edges: Vec<([u32; 2], Facet)> = Vec::with_capacity(3 * border.len());
        for (face, &slot) in border.iter().zip(&self.slots) {
            let ([a, b, c], beyond) = (face.corners(), face.beyond());
            let [u, v, w] = [a, b, c].map(|number| numbered[number as usize]);
            complex.write(slot, [q, u, v, w], [beyond, 0, 0, 0]);
            complex.set_neighbour(beyond, slot);
            edges.extend([(b, c, 1), (c, a, 2), (a, b, 3)].map(|(a, b, i)| ([a.min(b), a.max(b)], slot + i)));
        }
        edges.sort_unstable();
        for pair in edges.chunks_exact(2) {
            complex.set_neighbour(pair[0].1, pair[1].1);
            complex.set_neighbour(pair[1].1, pair[0].1);
        }
    }
}

//! The border of the cavity of a new point, and the star that replaces the cavity.

use super::complex::{Complex, Facet};
use super::tetrahedralization::Vertex;

/// Up to this number of vertices, edges are found in a table that stays in the first-level cache.
const STRIDE: usize = 64;

/// No vertex.
const NO_VERTEX: u32 = u32::MAX;

/// The known part of the cavity and of its border. The next insertion reuses the buffers.
#[derive(Debug)]
pub(super) struct Star {
    /// Tetrahedra of the cavity, whose places the star reuses.
    pub(super) slots: Vec<u32>,
    /// Facets of its border: numbers of their corners, counterclockwise as the new point sees them, and the
    /// facet of the tetrahedron outside.
    pub(super) border: Vec<([u32; 3], Facet)>,
    /// Vertices of the cavity, and behind them [`NO_VERTEX`].
    vertices: Vec<u32>,
    count: usize,
    /// For each directed edge of the border the facet of the star to its left.
    left: Box<[Facet; STRIDE * STRIDE]>,
}

impl Default for Star {
    fn default() -> Star {
        Star {
            slots: Vec::new(),
            border: Vec::new(),
            vertices: vec![NO_VERTEX; STRIDE],
            count: 0,
            left: Box::new([0; STRIDE * STRIDE]),
        }
    }
}

impl Star {
    /// Begins with one tetrahedron, whose vertices get the numbers 0 to 3.
    #[inline(always)]
    pub(super) fn open(&mut self, t: u32, corners: [u32; 4], vertices: &mut [Vertex]) {
        self.slots.clear();
        self.slots.push(t);
        self.border.clear();
        self.vertices[..4].copy_from_slice(&corners);
        self.count = 4;
        self.vertices[4] = NO_VERTEX;
        for (number, vertex) in (0..).zip(corners) {
            vertices[vertex as usize].local = number;
        }
    }

    /// Number of vertices that the buffers hold before they grow.
    #[inline(always)]
    pub(super) fn capacity(&self) -> usize {
        self.vertices.len()
    }

    /// The vertex with this number.
    #[inline(always)]
    pub(super) fn vertex(&self, number: u32) -> u32 {
        self.vertices[number as usize]
    }

    /// The number of a vertex; a vertex without a number gets the next one. Branch-free, because the branch
    /// would be unpredictable.
    #[inline(always)]
    pub(super) fn number(&mut self, vertex: u32, vertices: &mut [Vertex]) -> u32 {
        let entry = &mut vertices[vertex as usize];
        let next = self.count;
        let known = (entry.local as usize).min(next);
        let is_known = self.vertices[known] == vertex;
        let number = if is_known { known } else { next };
        self.vertices[next] = vertex;
        self.count = next + usize::from(!is_known);
        if self.count == self.vertices.len() {
            self.grow();
        }
        self.vertices[self.count] = NO_VERTEX;
        entry.local = number as u32;
        number as u32
    }

    #[cold]
    #[inline(never)]
    fn grow(&mut self) {
        self.vertices.resize(2 * self.vertices.len(), NO_VERTEX);
    }

    /// How many tetrahedra the star has beyond those of the cavity.
    #[inline(always)]
    pub(super) fn growth(&self) -> usize {
        self.border.len().saturating_sub(self.slots.len())
    }

    /// Writes the star of vertex `q` into the complex, which must have room for it; returns one of its
    /// tetrahedra.
    #[inline(always)]
    pub(super) fn close(&mut self, complex: &mut Complex<'_>, q: u32) -> u32 {
        let wanted = self.border.len();
        while self.slots.len() < wanted {
            let slot = complex.allocate();
            self.slots.push(slot);
        }
        complex.free.extend(self.slots.drain(wanted..));
        if self.count <= STRIDE {
            self.write_by_table(complex, q);
        } else {
            self.write_by_sorting(complex, q);
        }
        self.slots[wanted - 1]
    }

    /// A tetrahedron of the star has the new vertex as its corner 0, then those of the facet. Across from a
    /// corner of the facet is what lies to the left of the other two in opposite direction.
    #[inline(always)]
    fn write_by_table(&mut self, complex: &mut Complex<'_>, q: u32) {
        let edge = |a: u32, b: u32| (a as usize * STRIDE + b as usize) % (STRIDE * STRIDE);
        for (&([a, b, c], _), &slot) in self.border.iter().zip(&self.slots) {
            self.left[edge(b, c)] = slot + 1;
            self.left[edge(c, a)] = slot + 2;
            self.left[edge(a, b)] = slot + 3;
        }
        for (&([a, b, c], outside), &slot) in self.border.iter().zip(&self.slots) {
            let [u, v, w] = [a, b, c].map(|number| self.vertices[number as usize]);
            let neighbours = [outside, self.left[edge(c, b)], self.left[edge(a, c)], self.left[edge(b, a)]];
            complex.write(slot, [q, u, v, w], neighbours);
            complex.set_neighbour(outside, slot);
        }
    }

    /// The same for any number of vertices.
    #[cold]
    #[inline(never)]
    fn write_by_sorting(&mut self, complex: &mut Complex<'_>, q: u32) {
        let mut edges: Vec<([u32; 2], Facet)> = Vec::with_capacity(3 * self.border.len());
        for (&([a, b, c], outside), &slot) in self.border.iter().zip(&self.slots) {
            let [u, v, w] = [a, b, c].map(|number| self.vertices[number as usize]);
            complex.write(slot, [q, u, v, w], [outside, 0, 0, 0]);
            complex.set_neighbour(outside, slot);
            edges.extend([(b, c, 1), (c, a, 2), (a, b, 3)].map(|(a, b, i)| ([a.min(b), a.max(b)], slot + i)));
        }
        edges.sort_unstable();
        for pair in edges.chunks_exact(2) {
            complex.set_neighbour(pair[0].1, pair[1].1);
            complex.set_neighbour(pair[1].1, pair[0].1);
        }
    }
}

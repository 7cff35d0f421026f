//! The edges of a tetrahedralization, each once, with the tetrahedra around it.

use super::tetrahedralization::{Corner, Tetrahedralization, Tetrahedron};
use std::collections::VecDeque;

/// The corners of the six edges of a tetrahedron, and the two other corners: the way from the first of them
/// to the second turns right-handed around the edge.
pub const EDGES: [([usize; 2], [usize; 2]); 6] = [
    ([0, 1], [2, 3]),
    ([0, 2], [3, 1]),
    ([0, 3], [1, 2]),
    ([1, 2], [0, 3]),
    ([1, 3], [2, 0]),
    ([2, 3], [0, 1]),
];

/// The surroundings of an edge; reused for each edge.
#[derive(Debug, Default)]
pub struct Ring {
    /// The ends: vertices of the mesh.
    pub ends: [u32; 2],
    /// The tetrahedra around the edge, right-handed about the way from its first end to its second. Their
    /// numbers are those of [`Tetrahedralization::tetrahedra`].
    pub tetrahedra: VecDeque<u32>,
    /// The vertices that make a triangle with the edge. Tetrahedron `i` lies between vertices `i` and `i +
    /// 1`; the first vertex follows the last unless the edge is on the hull, where there is one vertex more
    /// than tetrahedra.
    pub link: VecDeque<u32>,
}

impl Tetrahedralization {
    /// Calls `visit` for each edge whose ends (vertices of the mesh) `is_wanted` accepts; the test may be
    /// asked several times for each edge.
    ///
    /// Each tetrahedron at an edge finds it; the tetrahedron with the lowest number reports it. The search
    /// for a lower number walks in both directions alternately, so that all searches around one edge of k
    /// tetrahedra take O(k log k) steps together, whatever the numbering.
    ///
    /// # Errors
    /// The first of `visit`.
    pub fn for_each_edge<E>(
        &self,
        is_wanted: impl Fn([u32; 2]) -> bool,
        mut visit: impl FnMut(&Ring) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut ring = Ring::default();
        for (t, tetrahedron) in (0..).zip(&self.tetrahedra) {
            for edge in &EDGES {
                let ends = edge.0.map(|corner| tetrahedron.vertices[corner]);
                if is_wanted(ends) && ring.fill(&self.tetrahedra, t, edge) {
                    visit(&ring)?;
                }
            }
        }
        Ok(())
    }
}

impl Ring {
    /// Walks around an edge of tetrahedron `start`. Returns whether no tetrahedron around the edge has a
    /// lower number; otherwise the ring is incomplete.
    fn fill(
        &mut self,
        tetrahedra: &[Tetrahedron],
        start: u32,
        &(ends, others): &([usize; 2], [usize; 2]),
    ) -> bool {
        let vertices = tetrahedra[start as usize].vertices;
        self.ends = ends.map(|corner| vertices[corner]);
        self.tetrahedra.clear();
        self.tetrahedra.push_back(start);
        self.link.clear();
        self.link.extend(others.map(|corner| vertices[corner]));
        let [first, second] = others;
        let mut walkers =
            [Walker::new(start, [first, second], vertices), Walker::new(start, [second, first], vertices)];
        loop {
            let mut moved = false;
            for turn in 0..2 {
                let Some(vertex) = walkers[turn].step(tetrahedra) else { continue };
                let t = walkers[turn].tetrahedron;
                if t < start {
                    return false;
                }
                if t == walkers[1 - turn].tetrahedron {
                    // Both walks met: the link ends with the vertex that it starts with.
                    self.link.pop_back();
                    return true;
                }
                if turn == 0 {
                    self.tetrahedra.push_back(t);
                    self.link.push_back(vertex);
                } else {
                    self.tetrahedra.push_front(t);
                    self.link.push_front(vertex);
                }
                moved = true;
            }
            if !moved {
                return true;
            }
        }
    }
}

/// Goes around an edge.
#[derive(Debug, Clone, Copy)]
struct Walker {
    tetrahedron: u32,
    /// Corner across which the next tetrahedron lies.
    exit: usize,
    /// Vertex that this and the next tetrahedron have beside the edge.
    hinge: u32,
    /// Whether the hull was reached.
    is_done: bool,
}

impl Walker {
    fn new(tetrahedron: u32, [exit, hinge]: [usize; 2], vertices: [u32; 4]) -> Self {
        Walker { tetrahedron, exit, hinge: vertices[hinge], is_done: false }
    }

    /// Steps into the next tetrahedron. Returns its vertex that the last one does not have, or `None` at the
    /// hull.
    fn step(&mut self, tetrahedra: &[Tetrahedron]) -> Option<u32> {
        if self.is_done {
            return None;
        }
        let Some(Corner { tetrahedron, corner }) = tetrahedra[self.tetrahedron as usize].neighbour(self.exit)
        else {
            self.is_done = true;
            return None;
        };
        let vertices = tetrahedra[tetrahedron as usize].vertices;
        let exit = vertices.iter().position(|&v| v == self.hinge);
        self.tetrahedron = tetrahedron;
        self.exit = exit.expect("tetrahedra across a facet have its vertices in common");
        self.hinge = vertices[corner as usize];
        Some(self.hinge)
    }
}

//! The edges of a tetrahedralization, each once, with the tetrahedra around it.

use spmesh_geometry::delaunay3::{Corner, Tetrahedralization, Tetrahedron};

/// The corners of the six edges of a tetrahedron, and the two other corners.
const EDGES: [([usize; 2], [usize; 2]); 6] = [
    ([0, 1], [2, 3]),
    ([0, 2], [1, 3]),
    ([0, 3], [1, 2]),
    ([1, 2], [0, 3]),
    ([1, 3], [0, 2]),
    ([2, 3], [0, 1]),
];

/// The surroundings of an edge; reused for each edge.
#[derive(Debug, Default)]
pub(super) struct Ring {
    /// The ends: vertices of the mesh.
    pub(super) ends: [u32; 2],
    /// The tetrahedra around the edge.
    pub(super) tetrahedra: Vec<u32>,
    /// The vertices that make a triangle with the edge.
    pub(super) link: Vec<u32>,
}

/// Calls `visit` for each edge of the mesh.
///
/// Each tetrahedron at an edge finds it; the tetrahedron with the lowest number reports it. The search for a
/// lower number walks in both directions alternately, so that all searches around one edge of k tetrahedra
/// take O(k log k) steps together, whatever the numbering.
pub(super) fn for_each_edge<E>(
    mesh: &Tetrahedralization,
    mut visit: impl FnMut(&Ring) -> Result<(), E>,
) -> Result<(), E> {
    let mut ring = Ring::default();
    for t in 0..mesh.tetrahedra().len() as u32 {
        for edge in &EDGES {
            if ring.fill(mesh.tetrahedra(), t, edge) {
                visit(&ring)?;
            }
        }
    }
    Ok(())
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
        self.tetrahedra.push(start);
        self.link.clear();
        self.link.extend(others.map(|corner| vertices[corner]));
        let [first, second] = others;
        let mut walkers =
            [Walker::new(start, [first, second], vertices), Walker::new(start, [second, first], vertices)];
        loop {
            let mut moved = false;
            for turn in 0..2 {
                let Some(vertex) = walkers[turn].step(tetrahedra) else { continue };
                if walkers[turn].tetrahedron < start {
                    return false;
                }
                if walkers[turn].tetrahedron == walkers[1 - turn].tetrahedron {
                    // Both walks met at the last vertex.
                    self.link.pop();
                    return true;
                }
                self.tetrahedra.push(walkers[turn].tetrahedron);
                self.link.push(vertex);
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

//! How the tetrahedra around a new point are linked.

use super::edges::{Edges, Shared};
use super::mesh::{FARAWAY, corner_of, facet, tetrahedron_of};
use super::wall::Wall;

/// The star of one new point at a time: a tetrahedron on each wall of its cavity.
#[derive(Debug)]
pub(super) struct Star {
    /// For each wall and its corners 1 to 3, the side of another wall: `wall * 4 + corner`.
    pub(super) beside: Vec<[u32; 4]>,
    /// Where the tetrahedra go.
    pub(super) slots: Vec<u32>,
    edges: Edges,
    /// For each vertex, and the faraway point, the last star that it is a corner of.
    seen: Vec<u32>,
    number: u32,
}

impl Star {
    /// Buffers for a mesh of `points` points.
    pub(super) fn new(points: usize) -> Star {
        Star {
            beside: Vec::new(),
            slots: Vec::new(),
            edges: Edges::default(),
            seen: vec![0; points + 1],
            number: 0,
        }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<u32>() * (self.seen.capacity() + self.slots.capacity())
            + size_of::<[u32; 4]>() * self.beside.capacity()
    }

    /// Finds the walls that share an edge: false unless the walls are a sphere.
    ///
    /// Two walls at each edge, with different corners opposite to it, make the tetrahedra of the star fit
    /// together, and one at least finite. By Euler's relation the surface is a sphere then, unless it is
    /// several that touch, or worse, and the number of vertices makes up for it by chance.
    #[inline(always)]
    pub(super) fn pair(&mut self, walls: &[Wall]) -> bool {
        self.number += 1;
        self.edges.clear(walls.len());
        self.beside.clear();
        self.beside.resize(walls.len(), [0; 4]);
        let (mut vertices, mut open) = (0, 0);
        for (number, wall) in walls.iter().enumerate() {
            let [_, a, b, c] = wall.vertices;
            for (corner, vertex, u, v) in [(1, a, b, c), (2, b, c, a), (3, c, a, b)] {
                let side = facet(number as u32, corner);
                match self.edges.enter(u, v, side) {
                    Shared::WithNone => open += 1,
                    Shared::With(other) => {
                        let (place, other_corner) = (tetrahedron_of(other) as usize, corner_of(other));
                        if walls[place].vertices[other_corner] == vertex {
                            return false;
                        }
                        open -= 1;
                        self.beside[number][corner] = other;
                        self.beside[place][other_corner] = side;
                    }
                    Shared::WithTwo => return false,
                }
                vertices += self.count(vertex);
            }
        }
        open == 0 && vertices >= 4 && walls.len() == 2 * vertices - 4
    }

    /// One for a vertex that is new in this star.
    #[inline(always)]
    fn count(&mut self, vertex: u32) -> usize {
        let last = self.seen.len() - 1;
        let seen = &mut self.seen[if vertex == FARAWAY { last } else { vertex as usize }];
        let is_new = *seen != self.number;
        *seen = self.number;
        usize::from(is_new)
    }
}

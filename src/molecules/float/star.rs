//! How the tetrahedra around a new point are linked, by the facets and edges around its cavity.

use super::mesh::{FARAWAY, Facet, corner_of, facet, faraway_corner, tetrahedron_of};
use super::sphere::Sphere;

/// The star of one new point at a time: a tetrahedron on each wall of its cavity.
#[derive(Debug)]
pub struct Star {
    /// For each wall and its corners 1 to 3, the side of another wall: `wall * 4 + corner`.
    pub beside: Vec<[u32; 4]>,
    /// Where the tetrahedra go.
    pub slots: Vec<u32>,
    edges: Edges,
    /// For each vertex, and the faraway point, the last star that it is a corner of.
    seen: Vec<u32>,
    number: u32,
}

impl Star {
    /// Buffers for a mesh of `points` points.
    pub fn new(points: usize) -> Star {
        Star {
            beside: Vec::new(),
            slots: Vec::new(),
            edges: Edges::default(),
            seen: vec![0; points + 1],
            number: 0,
        }
    }

    /// Memory of the table.
    pub fn bytes(&self) -> usize {
        size_of::<u32>() * (self.seen.capacity() + self.slots.capacity())
            + size_of::<[u32; 4]>() * self.beside.capacity()
    }

    /// Finds the walls that share an edge: false unless the walls are a sphere.
    ///
    /// Two walls at each edge, with different corners opposite to it, make the tetrahedra of the star fit
    /// together, and one at least finite. By Euler's relation the surface is a sphere then, unless it is
    /// several that touch, or worse, and the number of vertices makes up for it by chance.
    #[inline(always)]
    pub fn pair(&mut self, walls: &[Wall]) -> bool {
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

/// A facet around a cavity, as the new tetrahedron on it.
#[derive(Debug, Clone, Copy)]
pub struct Wall {
    /// The tetrahedron in the cavity.
    pub inside: u32,
    /// The facet, from outside of the cavity.
    pub outside: Facet,
    /// The new point, and the corners of the facet.
    pub vertices: [u32; 4],
    /// The sphere of the tetrahedron beyond it.
    pub sphere: Sphere,
}

impl Wall {
    /// Whether the new point sees the inner side of the facet.
    #[inline(always)]
    pub fn is_seen(&self) -> bool {
        self.sphere.volume > 0.0 || faraway_corner(&self.vertices).is_some()
    }
}

const CLOSED: u32 = u32::MAX;

#[derive(Debug, Clone, Copy, Default)]
struct Slot {
    edge: [u32; 2],
    /// The slot is empty unless this is the stamp of the table.
    stamp: u32,
    side: u32,
}

/// What a table of edges knows of the edge of a side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shared {
    /// No other side was at this edge so far.
    WithNone,
    /// This one was.
    With(u32),
    /// Two others were: the surface branches.
    WithTwo,
}

/// A hash table of the edges of one surface at a time.
#[derive(Debug, Default)]
pub struct Edges {
    slots: Vec<Slot>,
    stamp: u32,
}

impl Edges {
    /// Empties the table, and makes it large enough for the edges of a surface of `facets` triangles.
    pub fn clear(&mut self, facets: usize) {
        let slots = (4 * facets).next_power_of_two();
        if self.stamp == u32::MAX || self.slots.len() < slots {
            self.slots.clear();
            self.slots.resize(slots.max(256), Slot::default());
            self.stamp = 0;
        }
        self.stamp += 1;
    }

    /// Enters a side (below 2^32 - 1) at the edge between two vertices.
    ///
    /// Domain: at most three sides per facet of the surface that the table was cleared for.
    #[inline(always)]
    pub fn enter(&mut self, u: u32, v: u32, side: u32) -> Shared {
        let edge = [u.min(v), u.max(v)];
        let bits = (u64::from(edge[0]) << 32 | u64::from(edge[1])).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mut place = (bits >> 32) as usize & (self.slots.len() - 1);
        loop {
            let slot = &mut self.slots[place];
            if slot.stamp != self.stamp {
                *slot = Slot { edge, stamp: self.stamp, side };
                return Shared::WithNone;
            }
            if slot.edge == edge {
                let other = std::mem::replace(&mut slot.side, CLOSED);
                return if other == CLOSED { Shared::WithTwo } else { Shared::With(other) };
            }
            place = (place + 1) & (self.slots.len() - 1);
        }
    }
}

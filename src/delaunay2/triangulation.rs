//! What the kernel hands out: flat arrays.

/// No triangle: beyond an edge of the hull, or at a vertex without triangles.
pub const NONE: u32 = u32::MAX;

/// A corner of a triangle; it stands for the edge opposite to it, too.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Corner {
    /// Index of the triangle.
    pub triangle: u32,
    /// 0, 1 or 2.
    pub corner: u32,
}

/// A Delaunay triangulation. Vertices are indices into the array of input points.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Triangulation {
    /// Vertices of each triangle, counterclockwise. Triangles are about in the order of a Hilbert curve.
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle, the triangle across the edge opposite to each corner, or [`NONE`] on the hull.
    pub neighbours: Vec<[u32; 3]>,
    /// For each input point a triangle at it, such that turning counterclockwise from it meets all others before
    /// the hull; [`NONE`] for duplicates, and for all if there are no triangles.
    pub triangle_of_vertex: Vec<u32>,
    /// Vertices of the hull, counterclockwise; all points on its boundary are vertices. If there are no triangles,
    /// all distinct points, in lexicographic order.
    pub hull: Vec<u32>,
    /// Points left out because an equal point of lesser index is there: `[duplicate, vertex]`.
    pub duplicates: Vec<[u32; 2]>,
}

impl Triangulation {
    /// Empties all arrays, keeping their memory.
    pub(super) fn clear(&mut self) {
        self.triangles.clear();
        self.neighbours.clear();
        self.triangle_of_vertex.clear();
        self.hull.clear();
        self.duplicates.clear();
    }

    /// Corners at vertex `v`, counterclockwise; on the hull from the first edge to the last.
    pub fn corners_of(&self, v: u32) -> impl Iterator<Item = Corner> + '_ {
        let first = self.triangle_of_vertex[v as usize];
        let mut next = first;
        std::iter::from_fn(move || {
            if next == NONE {
                return None;
            }
            let triangle = next;
            let corner = self.triangles[triangle as usize].iter().position(|&w| w == v)?;
            next = self.neighbours[triangle as usize][(corner + 1) % 3];
            if next == first {
                next = NONE;
            }
            Some(Corner { triangle, corner: corner as u32 })
        })
    }

    /// The triangle to the left of the edge from `a` to `b`, as the corner opposite to the edge; `None` if there is
    /// no such edge or no triangle to its left. Cost: the degree of `a`.
    #[must_use]
    pub fn left_of(&self, a: u32, b: u32) -> Option<Corner> {
        self.corners_of(a).find_map(|Corner { triangle, corner }| {
            let next = (corner + 1) % 3;
            (self.triangles[triangle as usize][next as usize] == b)
                .then_some(Corner { triangle, corner: (corner + 2) % 3 })
        })
    }
}

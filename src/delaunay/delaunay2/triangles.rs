//! The output of the kernel: flat arrays.

use super::half_edge::{HalfEdge, NONE, WORDS, corner, number_of};
use bytemuck::{Pod, Zeroable};

/// A corner of a triangle; it stands for the edge opposite to it, too.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Corner {
    /// Index of the triangle.
    pub triangle: u32,
    /// 0, 1 or 2.
    pub corner: u32,
}

/// A triangle with its neighbours: half a cache line.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub struct Triangle {
    /// Vertices, counterclockwise.
    pub vertices: [u32; 3],
    unused: u32,
    /// The neighbouring half-edges of the edges opposite to the vertices.
    pub(super) neighbours: [HalfEdge; 3],
    unused_too: u32,
}

// SAFETY: zero is a value of every field.
unsafe impl Zeroable for Triangle {}
// SAFETY: all fields are numbers, and they fill it: nothing is padding.
unsafe impl Pod for Triangle {}

impl Triangle {
    pub(super) fn new(vertices: [u32; 3], neighbours: [HalfEdge; 3]) -> Triangle {
        Triangle { vertices, neighbours, ..Triangle::zeroed() }
    }

    /// The neighbour across the edge opposite to corner `side`, as its corner opposite to that edge; `None`
    /// at the hull.
    ///
    /// # Panics
    /// If `side` is above 2.
    #[inline]
    pub fn neighbour(&self, side: usize) -> Option<Corner> {
        let h = self.neighbours[side];
        (h != NONE).then(|| Corner { triangle: number_of(h), corner: corner(h) as u32 })
    }
}

/// The arrays of a Delaunay triangulation, which a [`Kernel`](super::Kernel) fills again and again. Vertices
/// are indices of input points; the points themselves are not kept.
#[derive(Debug, Clone, Default)]
pub struct Triangles {
    pub(super) memory: TriangleMemory,
    /// For each input point a triangle at it, from which a counterclockwise turn meets all others before the
    /// hull; [`NONE`] for duplicates, and for all if there are no triangles.
    pub triangle_of_vertex: Vec<u32>,
    /// Vertices of the hull, counterclockwise; all points on its boundary are vertices. If there are no
    /// triangles, all distinct points, in lexicographic order.
    pub hull: Vec<u32>,
    /// Points left out because an equal point of lesser index is there: `[duplicate, vertex]`.
    pub duplicates: Vec<[u32; 2]>,
}

impl Triangles {
    /// All triangles, about in the order of a Hilbert curve.
    #[inline]
    pub fn triangles(&self) -> &[Triangle] {
        &bytemuck::pod_align_to::<u32, Triangle>(&self.memory.words).1[..self.memory.count]
    }

    /// Corners at vertex `v`, counterclockwise; on the hull from the first edge to the last.
    pub fn corners_of(&self, v: u32) -> impl Iterator<Item = Corner> + '_ {
        let first = self.triangle_of_vertex[v as usize];
        let mut next = first;
        std::iter::from_fn(move || {
            let triangle = self.triangles().get(next as usize)?;
            let corner = triangle.vertices.iter().position(|&w| w == v)?;
            let at = Corner { triangle: next, corner: corner as u32 };
            next = triangle.neighbour((corner + 1) % 3).map_or(NONE, |neighbour| neighbour.triangle);
            if next == first {
                next = NONE;
            }
            Some(at)
        })
    }

    /// The triangle to the left of the edge from `a` to `b`, as the corner opposite to the edge; `None` if
    /// there is no such edge or no triangle to its left. Cost: the degree of `a`.
    pub fn left_of(&self, a: u32, b: u32) -> Option<Corner> {
        self.corners_of(a).find_map(|Corner { triangle, corner }| {
            let next = (corner + 1) % 3;
            (self.triangles()[triangle as usize].vertices[next as usize] == b)
                .then_some(Corner { triangle, corner: (corner + 2) % 3 })
        })
    }

    /// Empties all arrays, keeping their memory.
    pub(super) fn clear(&mut self) {
        self.memory.count = 0;
        self.triangle_of_vertex.clear();
        self.hull.clear();
        self.duplicates.clear();
    }
}

/// Memory of triangles, where the kernel builds them.
#[derive(Debug, Default)]
pub(super) struct TriangleMemory {
    words: Vec<u32>,
    count: usize,
}

impl TriangleMemory {
    /// Memory for the triangles of `vertices` vertices, including the vertex at infinity. Its content is
    /// arbitrary.
    ///
    /// The system zeroes fresh memory when it is first touched; nothing is zeroed here.
    pub(super) fn allocate(&mut self, vertices: usize) -> &mut [u32] {
        let words = 2 * vertices * WORDS;
        // Up to one triangle is lost to alignment.
        if self.words.len() < words + WORDS {
            self.words = Vec::new();
            self.words = vec![0; words + WORDS];
        }
        let (_, triangles, _) = bytemuck::pod_align_to_mut::<u32, Triangle>(&mut self.words);
        &mut bytemuck::cast_slice_mut(triangles)[..words]
    }

    /// Makes the first `count` triangles of that memory those of the triangulation.
    pub(super) fn set_count(&mut self, count: usize) {
        self.count = count;
    }

    /// Keeps the triangles, and makes their number `count`. Those that are new have arbitrary content.
    ///
    /// Cost: amortised, the number of new triangles.
    pub(super) fn resize(&mut self, count: usize) -> &mut [Triangle] {
        if self.words.len() < (count + 1) * WORDS {
            // Twice as many, so that each is moved a few times at most.
            self.words = self.copy(count).words;
        }
        self.count = count;
        &mut bytemuck::pod_align_to_mut::<u32, Triangle>(&mut self.words).1[..count]
    }

    /// The triangles in memory of their own, for the triangles of `vertices` vertices. A vector of words
    /// alone could have another alignment there.
    fn copy(&self, vertices: usize) -> TriangleMemory {
        let mut copy = TriangleMemory::default();
        let triangles = &bytemuck::pod_align_to::<u32, Triangle>(&self.words).1[..self.count];
        copy.allocate(vertices)[..self.count * WORDS].copy_from_slice(bytemuck::cast_slice(triangles));
        copy.count = self.count;
        copy
    }
}

impl Clone for TriangleMemory {
    fn clone(&self) -> TriangleMemory {
        self.copy(self.count.div_ceil(2))
    }
}

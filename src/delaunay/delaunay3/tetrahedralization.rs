//! The output of the kernel: flat arrays.

use super::stats::Stats;
use crate::predicates::Point3;
use bytemuck::{Pod, Zeroable};

/// No tetrahedron: beyond a facet of the hull.
pub const NONE: u32 = u32::MAX;

/// A corner of a tetrahedron; it stands for the facet opposite to it, too.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Corner {
    /// Index of the tetrahedron.
    pub tetrahedron: u32,
    /// 0, 1, 2 or 3.
    pub corner: u32,
}

/// A vertex: half a cache line.
#[derive(Debug, Clone, Copy, Default)]
#[repr(C, align(32))]
pub struct Vertex {
    /// Where it is.
    pub at: Point3,
    /// Index of the input point.
    pub index: u32,
    unused: u32,
}

// SAFETY: zero is a value of every field.
unsafe impl Zeroable for Vertex {}
// SAFETY: all fields are numbers, and they fill it: nothing is padding.
unsafe impl Pod for Vertex {}

impl Vertex {
    /// The input point of this index.
    #[inline(always)]
    pub fn new(at: Point3, index: u32) -> Vertex {
        Vertex { at, index, unused: 0 }
    }
}

/// A tetrahedron with its neighbours: half a cache line.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub struct Tetrahedron {
    /// Indices of its vertices a, b, c, d, such that det(b - a, c - a, d - a) > 0.
    pub vertices: [u32; 4],
    /// The neighbouring facets opposite to the vertices, as words of the array of tetrahedra.
    pub(super) neighbours: [u32; 4],
}

// SAFETY: zero is a value of every field.
unsafe impl Zeroable for Tetrahedron {}
// SAFETY: all fields are numbers, and they fill it: nothing is padding.
unsafe impl Pod for Tetrahedron {}

pub(super) const WORDS: usize = size_of::<Tetrahedron>() / size_of::<u32>();

impl Tetrahedron {
    /// A tetrahedron made elsewhere, with what is across from each corner.
    pub fn new(vertices: [u32; 4], neighbours: [Option<Corner>; 4]) -> Tetrahedron {
        let word = |corner: Corner| corner.tetrahedron * WORDS as u32 + corner.corner;
        Tetrahedron { vertices, neighbours: neighbours.map(|corner| corner.map_or(NONE, word)) }
    }

    /// The neighbour across the facet opposite to corner `side`, as its corner opposite to that facet; `None`
    /// at the hull.
    ///
    /// # Panics
    /// If `side` is above 3.
    #[inline]
    pub fn neighbour(&self, side: usize) -> Option<Corner> {
        let word = self.neighbours[side];
        (word != NONE).then_some(Corner { tetrahedron: word / WORDS as u32, corner: word & 3 })
    }
}

/// A Delaunay tetrahedralization.
///
/// [`Tetrahedralization::tetrahedra`] and [`Tetrahedralization::vertices`] are the arrays of the kernel, in
/// which a tetrahedron names its vertices by their places in the array of vertices. All other methods speak
/// of indices of input points, like those of [`Triangulation`](crate::delaunay2::Triangulation).
#[derive(Debug, Default)]
#[non_exhaustive]
pub struct Tetrahedralization {
    pub(super) vertices: Vec<Vertex>,
    pub(super) tetrahedra: Vec<Tetrahedron>,
    /// Input points left out because an equal one of lesser index is there: `[duplicate, the other]`.
    pub duplicates: Vec<[u32; 2]>,
    /// Input points whose cell in the power diagram is empty, so that they are in no tetrahedron: with
    /// weights only, and unknown if there are no tetrahedra. They are vertices still.
    pub hidden: Vec<u32>,
    /// Number of facets of the hull.
    pub hull_facets: usize,
    /// Work and time that it took.
    pub stats: Stats,
}

impl Tetrahedralization {
    /// A tetrahedralization made elsewhere, without stats.
    pub fn from_parts(
        vertices: Vec<Vertex>,
        duplicates: Vec<[u32; 2]>,
        tetrahedra: Vec<Tetrahedron>,
    ) -> Tetrahedralization {
        let sides = tetrahedra.iter().flat_map(|tetrahedron| tetrahedron.neighbours);
        let hull_facets = sides.filter(|&neighbour| neighbour == NONE).count();
        Tetrahedralization {
            vertices,
            tetrahedra,
            duplicates,
            hidden: Vec::new(),
            hull_facets,
            stats: Stats::default(),
        }
    }

    /// The vertices, which are the distinct points, in order along a curve.
    #[inline]
    pub fn vertices(&self) -> &[Vertex] {
        &self.vertices
    }

    /// All tetrahedra, about in the order of the curve. None if all points lie in a plane.
    #[inline]
    pub fn tetrahedra(&self) -> &[Tetrahedron] {
        &self.tetrahedra
    }

    /// Empties everything, keeping the memory.
    pub(super) fn clear(&mut self) {
        self.vertices.clear();
        self.tetrahedra.clear();
        self.duplicates.clear();
        self.hidden.clear();
        self.hull_facets = 0;
        self.stats = Stats::default();
    }
}

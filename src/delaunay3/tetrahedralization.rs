//! What the kernel hands out: flat arrays.

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

/// A tetrahedron with its neighbours: half a cache line.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C, align(32))]
pub struct Tetrahedron {
    /// Vertices a, b, c, d, such that det(b - a, c - a, d - a) > 0.
    pub vertices: [u32; 4],
    /// Where the facets opposite to the vertices are in the words of their other tetrahedra.
    across: [u32; 4],
}

impl Tetrahedron {
    /// A tetrahedron with what is across from each corner.
    pub(crate) fn new(vertices: [u32; 4], across: [Option<Corner>; 4]) -> Tetrahedron {
        let word = |corner: Corner| corner.tetrahedron * 8 + corner.corner;
        Tetrahedron { vertices, across: across.map(|corner| corner.map_or(NONE, word)) }
    }

    /// The tetrahedron across the facet opposite to a corner, as its corner opposite to that facet; `None` beyond the
    /// hull.
    #[inline]
    #[must_use]
    pub fn across(&self, side: usize) -> Option<Corner> {
        let word = self.across[side];
        (word != NONE).then_some(Corner { tetrahedron: word / 8, corner: word & 3 })
    }
}

/// A Delaunay tetrahedralization.
#[derive(Debug, Default)]
pub struct Tetrahedralization {
    /// The vertices: the distinct points, in order along a curve.
    pub points: Vec<Point3>,
    /// Input index of each vertex.
    pub indices: Vec<u32>,
    /// Input points left out because an equal one of lesser index is there: `[duplicate, the other]`.
    pub duplicates: Vec<[u32; 2]>,
    pub(super) tetrahedra: Vec<Tetrahedron>,
}

impl Tetrahedralization {
    /// Gives it tetrahedra that were made elsewhere.
    pub(crate) fn set_tetrahedra(&mut self, tetrahedra: Vec<Tetrahedron>) {
        self.tetrahedra = tetrahedra;
    }

    /// All tetrahedra, about in the order of the curve; vertices are indices of `points`. None if all points lie in
    /// a plane.
    #[inline]
    #[must_use]
    pub fn tetrahedra(&self) -> &[Tetrahedron] {
        &self.tetrahedra
    }
}

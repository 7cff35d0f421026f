//! Where a point lies with respect to a mesh.

use crate::predicates::Sign;

/// Where a point lies: in the interior of exactly one simplex of some dimension, or outside. Vertices are
/// indices of input points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Location {
    /// At this vertex.
    Vertex(u32),
    /// On the edge between two vertices, the lesser one first.
    Edge([u32; 2]),
    /// Within a facet between two tetrahedra or on the hull, vertices increasing. Only in space.
    Facet([u32; 3]),
    /// Inside of the triangle or tetrahedron of this number.
    Simplex(u32),
    /// Outside of the hull.
    Outside,
}

impl Location {
    /// The location of a point in a closed simplex, given the side of the point at the facet opposite to each
    /// vertex.
    ///
    /// Domain: no sign is negative, and one at least is positive. The point lies in the face of the vertices
    /// with positive signs.
    pub(crate) fn in_simplex<const N: usize>(number: u32, vertices: [u32; N], signs: [Sign; N]) -> Location {
        let mut face = [u32::MAX; N];
        let mut count = 0;
        for (vertex, sign) in vertices.into_iter().zip(signs) {
            if sign == Sign::Positive {
                face[count] = vertex;
                count += 1;
            }
        }
        let face = &mut face[..count];
        face.sort_unstable();
        match *face {
            [v] => Location::Vertex(v),
            [u, v] if N > 2 => Location::Edge([u, v]),
            [u, v, w] if N > 3 => Location::Facet([u, v, w]),
            _ => Location::Simplex(number),
        }
    }
}

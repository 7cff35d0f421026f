//! The table of stream kinds: the name of each kind, and the blocks it may hold.

use super::block::Tag;

/// What a stream holds. A new kind is one row in the table of this file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Points, with the tags of cells that no later point lies in.
    Points,
    /// A triangle mesh in patches, vertices finalized after their last triangle.
    TriangleMesh,
    /// The final triangles of a region and its residual, to be merged with those of other regions.
    PartialTriangleMesh,
    /// A tetrahedral mesh in patches, vertices finalized after their last tetrahedron; either all vertices
    /// have a label or none has.
    TetrahedralMesh,
    /// Points of four dimensions; either all have a value or none has.
    Points4,
    /// Points of four dimensions and the cells between them.
    Cells4,
    /// Points of four dimensions and the simplices between them.
    Simplices4,
    /// Knots, and their configurations (B, I) of one or several degrees. Functions of quadratic splines are
    /// listed if links of degree 1 make functions other than B-splines.
    Configurations,
    /// Knots with configurations of one degree, functions as above, and their coefficients.
    Splines,
    /// The final tetrahedra of a region and its residual, to be merged with those of other regions.
    PartialTetrahedralMesh,
    /// The residual of a part of a triangle mesh, whose final triangles are in a stream of their own.
    TriangleResidual,
    /// The residual of a part of a tetrahedral mesh, whose final tetrahedra are in a stream of their own.
    TetrahedralResidual,
    /// Points of space in regions that overlap, one region after the other. A point of several regions is in
    /// the stream once for each of them.
    RegionPoints,
}

struct Row {
    kind: Kind,
    code: u16,
    name: &'static str,
    dims: &'static [u8],
    vertices_per_simplex: usize,
    /// Blocks in groups: all blocks of a group come before those of the next one, in any order.
    blocks: &'static [&'static [Tag]],
}

const ROWS: [Row; 13] = [
    Row {
        kind: Kind::Points,
        code: 1,
        name: "points",
        dims: &[2, 3],
        vertices_per_simplex: 0,
        blocks: &[&[Tag::Points, Tag::Cells]],
    },
    Row {
        kind: Kind::TriangleMesh,
        code: 2,
        name: "triangle mesh",
        dims: &[2],
        vertices_per_simplex: 3,
        blocks: &[&[Tag::Segments, Tag::Sides, Tag::Origins, Tag::Kept, Tag::Patch], &[Tag::OpenSegments]],
    },
    Row {
        kind: Kind::PartialTriangleMesh,
        code: 3,
        name: "partial triangle mesh",
        dims: &[2],
        vertices_per_simplex: 3,
        blocks: &[&[Tag::Patch], &[Tag::ResidualPoints], &[Tag::Walls]],
    },
    Row {
        kind: Kind::TetrahedralMesh,
        code: 4,
        name: "tetrahedral mesh",
        dims: &[3],
        vertices_per_simplex: 4,
        blocks: &[&[Tag::Origins, Tag::Kept, Tag::Patch, Tag::Labels]],
    },
    Row {
        kind: Kind::Points4,
        code: 5,
        name: "points in 4 dimensions",
        dims: &[4],
        vertices_per_simplex: 0,
        blocks: &[&[Tag::Points4]],
    },
    Row {
        kind: Kind::Cells4,
        code: 6,
        name: "cells in 4 dimensions",
        dims: &[4],
        vertices_per_simplex: 0,
        blocks: &[&[Tag::Points4], &[Tag::Cells4]],
    },
    Row {
        kind: Kind::Simplices4,
        code: 7,
        name: "simplices in 4 dimensions",
        dims: &[4],
        vertices_per_simplex: 0,
        blocks: &[&[Tag::Points4], &[Tag::Simplices4]],
    },
    Row {
        kind: Kind::Configurations,
        code: 8,
        name: "configurations",
        dims: &[2],
        vertices_per_simplex: 0,
        blocks: &[&[Tag::Points], &[Tag::Configurations], &[Tag::Functions]],
    },
    Row {
        kind: Kind::Splines,
        code: 9,
        name: "splines",
        dims: &[2],
        vertices_per_simplex: 0,
        blocks: &[&[Tag::Points], &[Tag::Configurations], &[Tag::Functions], &[Tag::Coefficients]],
    },
    Row {
        kind: Kind::PartialTetrahedralMesh,
        code: 10,
        name: "partial tetrahedral mesh",
        dims: &[3],
        vertices_per_simplex: 4,
        blocks: &[&[Tag::Patch], &[Tag::ResidualPoints], &[Tag::Walls]],
    },
    Row {
        kind: Kind::TriangleResidual,
        code: 11,
        name: "residual of a triangle mesh",
        dims: &[2],
        vertices_per_simplex: 3,
        blocks: &[&[Tag::ResidualPoints], &[Tag::Walls]],
    },
    Row {
        kind: Kind::TetrahedralResidual,
        code: 12,
        name: "residual of a tetrahedral mesh",
        dims: &[3],
        vertices_per_simplex: 4,
        blocks: &[&[Tag::ResidualPoints], &[Tag::Walls]],
    },
    Row {
        kind: Kind::RegionPoints,
        code: 13,
        name: "points in regions",
        dims: &[3],
        vertices_per_simplex: 0,
        blocks: &[&[Tag::Region, Tag::Points]],
    },
];

impl Kind {
    fn row(self) -> &'static Row {
        ROWS.iter().find(|row| row.kind == self).expect("every kind has its row")
    }

    /// The kind with this code in the header, if there is one.
    pub(crate) fn from_code(code: u16) -> Option<Self> {
        ROWS.iter().find(|row| row.code == code).map(|row| row.kind)
    }

    /// The kind with this name, if there is one.
    pub fn from_name(name: &str) -> Option<Self> {
        ROWS.iter().find(|row| row.name == name).map(|row| row.kind)
    }

    /// The code in the header.
    pub fn code(self) -> u16 {
        self.row().code
    }

    /// The name in messages and in JSON.
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// Dimensions that the geometry may have.
    pub fn dims(self) -> &'static [u8] {
        self.row().dims
    }

    /// Whether the geometry is four-dimensional, with block types of its own.
    pub fn is_4d(self) -> bool {
        self.dims() == [4]
    }

    /// Whether END counts vertices and merged points besides points. Knots of configurations count as points.
    pub fn has_vertices(self) -> bool {
        !matches!(self, Kind::Points | Kind::RegionPoints | Kind::Points4) && !self.has_knots()
    }

    /// Whether the points are knots, followed by their configurations.
    pub fn has_knots(self) -> bool {
        matches!(self, Kind::Configurations | Kind::Splines)
    }

    /// Whether the stream is the mesh of a region, with a residual that is merged with others.
    pub fn is_partial(self) -> bool {
        matches!(self, Kind::PartialTriangleMesh | Kind::PartialTetrahedralMesh)
    }

    /// Whether the stream is the residual of a part, and nothing else.
    pub fn is_residual(self) -> bool {
        matches!(self, Kind::TriangleResidual | Kind::TetrahedralResidual)
    }

    /// Whether the header states a region, which all points of the stream lie in.
    pub fn has_region(self) -> bool {
        self.is_partial() || self.is_residual()
    }

    /// Whether the header may have a finalization tree.
    pub fn may_have_tree(self) -> bool {
        let is_without = matches!(self, Kind::PartialTetrahedralMesh | Kind::RegionPoints);
        !self.is_4d() && !self.has_knots() && !self.is_residual() && !is_without
    }

    /// Vertices of a simplex of a patch; 0 where the kind holds no patches.
    pub fn vertices_per_simplex(self) -> usize {
        self.row().vertices_per_simplex
    }

    /// Vertices of a wall, which is a facet of a simplex; 0 where the kind holds no patches.
    pub fn vertices_per_wall(self) -> usize {
        self.vertices_per_simplex().saturating_sub(1)
    }

    /// Whether points of such a stream may carry attributes.
    pub fn may_have_attributes(self) -> bool {
        matches!(self, Kind::Points | Kind::RegionPoints) || self.vertices_per_simplex() > 0
    }

    /// Whether a block of tag `tag` may follow one of tag `last` (`None` at the start) in such a stream.
    pub(super) fn allows(self, last: Option<Tag>, tag: Tag) -> bool {
        let rank = |tag: Tag| self.row().blocks.iter().position(|group| group.contains(&tag));
        match (rank(tag), last.and_then(rank)) {
            (Some(rank), Some(last)) => last <= rank,
            (Some(_), None) => true,
            (None, _) => tag == Tag::End,
        }
    }
}
